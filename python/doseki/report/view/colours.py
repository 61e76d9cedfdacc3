"""By what a view can be coloured: fields with limits, or names with colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps, colors

from ...figures.colouring import SCALE, limits, palette
from ...measure.columns import column_depth
from ...measure.numbers import speed
from ...measure.views import fluid_names
from ...record.fields import FIELD_BY_KEY
from ...record.quantities import CATEGORIES
from ...record.reader import Run, Snapshot
from .coding import small

CELL = 3.0  # spacings: side of the columns whose depth is measured
SPEED, PRESSURE, DEPTH = "speed", "pressure", "depth"


@dataclass(frozen=True)
class Field:
    """A quantity from `low` to `high`, in `unit`; or one of `names`, each with its colour.

    Both limits are the same number where nothing has another one.
    """

    name: str
    unit: str = ""
    low: float = 0.0
    high: float = 1.0
    names: tuple[str, ...] | None = None
    colours: tuple[str, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """For the page."""
        said: dict[str, Any] = {"name": self.name, "label": self.name, "unit": self.unit}
        if self.names is None:
            return said | {"low": self.low, "high": self.high}
        return said | {"names": self.names, "colours": self.colours}

    def share(self, values: np.ndarray) -> np.ndarray:
        """Numbers of 8 bits: from the lower to the upper limit, or the index of a name."""
        if self.names is None:
            return small((values - self.low) / ((self.high - self.low) or 1.0))
        return (values % 256).astype(np.uint8)


def scale() -> list[str]:
    """The 256 colours of fields, from low to high."""
    return [colors.to_hex(colour) for colour in colormaps[SCALE](np.linspace(0, 1, 256))]


def values_of(snapshot: Snapshot, name: str) -> np.ndarray:
    """Values (N,) of a field, or indices of names as the record has them.

    The depth of what does not move is 0.
    """
    if name in CATEGORIES:
        return snapshot.stored(name)
    if name == SPEED:
        return speed(snapshot["velocity"])
    if name == DEPTH:
        return _depth(snapshot)
    return snapshot[name]


def _depth(snapshot: Snapshot) -> np.ndarray:
    moves = ~snapshot["fixed"] & np.isfinite(snapshot["position"]).all(axis=1)
    depth = np.zeros(len(moves))
    volume = (snapshot["mass"] / snapshot["density"])[moves]
    if len(volume):
        cell = CELL * float(np.median(volume)) ** (1 / snapshot.dim)
        depth[moves] = column_depth(snapshot["position"][moves], volume, cell)
    return depth


def fields_of(run: Run, samples: Sequence[Snapshot]) -> list[Field]:
    """What the view of a run can be coloured by; limits are those of what moves in `samples`."""
    first = samples[0]
    fluids = fluid_names(run)
    numbers = [SPEED]
    if any(_moving(each, PRESSURE).any() for each in samples):  # deformable bodies have none
        numbers.append(PRESSURE)
    if fluids & set(first.material_names) and any(run.scenario.get("gravity", [])):
        numbers.append(DEPTH)
    found = [_number(name, samples) for name in numbers]
    found += [_category(name, samples, fluids) for name in CATEGORIES]
    return found


def _moving(snapshot: Snapshot, name: str) -> np.ndarray:
    """Values of a field that what moves has."""
    return values_of(snapshot, name)[~snapshot["fixed"]]


def _number(name: str, samples: Sequence[Snapshot]) -> Field:
    low, high = limits(np.concatenate([_moving(each, name) for each in samples]))
    key = {SPEED: "velocity", DEPTH: "position"}.get(name, name)
    unit = FIELD_BY_KEY[key].unit_in(samples[0].dim)
    if name != PRESSURE:
        low = 0.0
    return Field(name, unit, low, high)


def _of_bodies(name: str, samples: Sequence[Snapshot]) -> set[str]:
    """The names of rigid bodies, which may have no particle of their own in a sample."""
    return {str(b) for s in samples for b in s.grains.get("body", ())} if name == "body" else set()


def _category(name: str, samples: Sequence[Snapshot], fluids: set[str]) -> Field:
    """Names that nothing has which moves have no colour of their own: they are never looked up."""
    first = samples[0]
    names = first.material_names if name == "material" else first.body_names
    used: set[int] = set()
    for snapshot in samples:
        used |= set(np.unique(snapshot.stored(name)[~snapshot["fixed"]]).tolist())
    kinds = sorted({*(names[k] for k in used if 0 <= k < len(names)), *_of_bodies(name, samples)})
    colour = palette(kinds, name, fluids)
    return Field(
        name,
        names=tuple(names[:256]),
        colours=tuple(colour.get(kind, "") for kind in names[:256]),
    )
