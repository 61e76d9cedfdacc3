"""What a figure looks at: the windows of a scenario, and the snapshots that matter in them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ..errors import UserError
from ..record.reader import GaugeRecord, Run, Snapshot
from ..scenario.materials import Material, MaterialError, complete_materials
from ..scenario.reading.messages import to_user_error
from ..scenario.table import Kinds, Part, Table
from ..scenario.tables.inflow import Inflow
from ..scenario.tables.material import MaterialTable
from ..scenario.tables.region import Window
from ..scenario.tables.sections import SECTIONS
from ..scenario.values.toml_source import Where, read_toml
from ..util.spelling import suggestion
from . import numbers as measure

T = TypeVar("T", bound=Table)
P = TypeVar("P", bound=Part)

LEVEL = 1e-9  # slope, or balance of inflows or of momenta, that rounding makes
FLOW_SHARE = 0.5  # of the most fluid that a window ever holds


@dataclass(frozen=True)
class View:
    """A box in axes turned by `rotate` degrees about the origin; bounds may be infinite."""

    lower: np.ndarray
    upper: np.ndarray
    rotate: float = 0.0
    title: str = ""

    def coordinates(self, position: np.ndarray) -> np.ndarray:
        """Positions (N, dim) in the axes of the view."""
        return measure.to_frame(position, self.rotate)

    def contains(self, position: np.ndarray) -> np.ndarray:
        """Whether each particle (N,) is in the view."""
        return measure.in_window(position, self.lower, self.upper, self.rotate)


def whole_space(dim: int, rotate: float = 0.0) -> View:
    """The view that shows everything."""
    return View(np.full(dim, -math.inf), np.full(dim, math.inf), rotate)


def tables(run: Run, section: str, kind: type[P]) -> dict[str, P]:
    """The enabled tables [section.NAME] of a run's scenario by name, defaults filled in.

    They are all of `kind`.  Raises UserError for a scenario.toml that was changed by hand to
    something impossible.
    """
    read = _all_tables(run, section, kind)
    return {name: table for name, table in read.items() if table.enabled}


def _all_tables(run: Run, section: str, kind: type[T]) -> dict[str, T]:
    found = SECTIONS[section]
    entry: Any = found.union if isinstance(found, Kinds) else found
    adapter: TypeAdapter[dict[str, T]] = TypeAdapter(dict[str, entry])
    given = run.scenario.get(section, {})
    try:
        return adapter.validate_python(given, context={"dim": run.scenario["dim"]})
    except ValidationError as error:
        raise to_user_error(error, given, _where(run), (section,)) from None


def _where(run: Run) -> Where:
    return Where([read_toml(run.folder.scenario)])


def gauge_record(run: Run, name: str) -> GaugeRecord:
    """What the gauge [gauge.NAME] of a run has read; raises UserError where its file is gone."""
    if name not in run.gauges:
        raise UserError(f"{run.folder.gauge(name)}: no such file; [gauge.{name}] writes it")
    return run.gauges[name]


def windows(run: Run) -> dict[str, View]:
    """The windows of a run's scenario."""
    return {
        name: View(table.min, table.max, table.rotate, table.title)
        for name, table in tables(run, "window", Window).items()
    }


def named_window(run: Run, name: str | None) -> View:
    """The window of this name, or all space for None; raises UserError for an unknown name."""
    if name is None:
        return whole_space(run.scenario["dim"])
    known = windows(run)
    if name not in known:
        raise UserError(f"{run.directory}: no window is called {name!r}{suggestion(name, known)}")
    return known[name]


def materials_of(run: Run) -> dict[str, Material]:
    """The materials of a run by name; raises as `tables` does."""
    read = _all_tables(run, "material", MaterialTable)
    given = {name: table.model_dump(exclude_none=True) for name, table in read.items()}
    try:
        return complete_materials(given)
    except MaterialError as error:
        keys = ("material", error.material)
        raise _where(run).error(keys, f"material.{error.material}: {error}") from None


def fluid_names(run: Run) -> set[str]:
    """The materials that flow."""
    return {name for name, material in materials_of(run).items() if material.law == "fluid"}


def tilt(run: Run) -> float:
    """Angle of the slope, degrees: how far the last axis leans from the vertical."""
    gravity = run.scenario.get("gravity", [0.0])
    return math.degrees(math.atan2(-gravity[0], -gravity[-1])) if any(gravity) else 0.0


def flow_direction(run: Run) -> int:
    """+1 or -1: the way along the first axis that a flow takes; 0 where the scenario does not say.

    Gravity says it; on level ground the inflows do, each as far as its discharge goes.
    """
    gravity = np.array(run.scenario.get("gravity", [0.0]))
    if abs(gravity[0]) > LEVEL * np.linalg.norm(gravity):
        return int(np.sign(gravity[0]))
    inflows = tables(run, "inflow", Inflow).values()
    along = [t.peak_rate * t.direction[0] / np.linalg.norm(t.direction) for t in inflows]
    fluxes = np.abs(along).sum()
    return int(np.sign(sum(along))) if abs(sum(along)) > LEVEL * fluxes else 0


def what_flows(run: Run) -> set[str] | None:
    """The fluids of a run; None, for all that moves, where it has none."""
    return fluid_names(run) & set(run[0].material_names) or None


@lru_cache(maxsize=4)
def way_of_flow(run: Run) -> int:
    """+1 or -1: the way along the first axis that a flow takes; 0 where nothing goes along it.

    Where the scenario does not say it, as on a terrain, the momentum of what flows does, in the
    snapshot in which its kinetic energy is largest.
    """
    direction = flow_direction(run)
    if direction or not len(run):
        return direction
    everywhere, materials = whole_space(run.scenario["dim"]), what_flows(run)
    looks = [_motion(snapshot, select(snapshot, everywhere, materials)) for snapshot in run]
    _, momentum, most = max(looks, key=lambda look: look[0])
    return int(np.sign(momentum)) if abs(momentum) > LEVEL * most else 0


def _motion(snapshot: Snapshot, chosen: np.ndarray) -> tuple[float, float, float]:
    """Twice the kinetic energy, J; momentum along the first axis, kg m/s, and its largest size."""
    mass, velocity = snapshot["mass"][chosen], snapshot["velocity"][chosen]
    energy = float(mass @ (velocity**2).sum(axis=1))
    return energy, float(mass @ velocity[:, 0]), float((mass.sum() * energy) ** 0.5)


def select(snapshot: Snapshot, view: View, materials: set[str] | None = None) -> np.ndarray:
    """Mask (N,) of the particles that can move, are in the view and of one of the materials."""
    mask = view.contains(snapshot["position"]) & ~snapshot["fixed"]
    if materials is not None:
        mask &= np.isin(snapshot["material"], sorted(materials))
    return mask


def before_flow(run: Run, view: View) -> int:
    """Index of the last snapshot before any fluid is in the view (0 if it is there at once)."""
    fluids = fluid_names(run)
    for index, snapshot in enumerate(run):
        if np.any(select(snapshot, view, fluids)):
            return max(index - 1, 0)
    return len(run) - 1


def with_flow(run: Run, view: View) -> int:
    """Index of the first snapshot in which a flow fills the view, or most of it.

    Then there is at least half as much fluid as there ever is; spray ahead of a flow is not one.
    """
    fluids = fluid_names(run)
    filled, mass = np.array([_filled(snapshot, view, fluids) for snapshot in run]).T
    if not mass.any():
        return len(run) - 1
    return int(np.argmax(np.where(mass >= FLOW_SHARE * mass.max(), filled, -1)))


def _filled(snapshot: Snapshot, view: View, fluids: set[str]) -> tuple[float, float]:
    """Along which share of the view there is fluid, and the mass of it."""
    inside = select(snapshot, view, fluids)
    position, mass = snapshot["position"][inside], float(snapshot["mass"][inside].sum())
    start, end = view.lower[0], view.upper[0]
    if not (math.isfinite(start) and math.isfinite(end)):
        return float(len(position) > 0), mass
    return measure.filled_fraction(view.coordinates(position)[:, 0], start, end), mass
