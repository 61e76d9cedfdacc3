"""What a gauge is: a table [gauge.NAME] that knows its columns and how it is read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
from pydantic import Field

from ..array import Array
from ..table import Part
from ..values.types import Duration, OptionalMaterialName, Position

State = Mapping[str, np.ndarray]  # fields of particles by name, as record.fields has them
Rows = list[list[float]]
FacesAt = Callable[[float], np.ndarray]  # pieces (n, dim, dim) of faces by corners, m, at a time, s


class Sampled(Protocol):
    """The particles of a running simulation, as far as gauges look at them."""

    @property
    def time(self) -> float:
        """Simulated time, s."""

    def sample(self, low: list[float], high: list[float]) -> State:
        """Fields of the particles in a box (m), on all ranks."""

    def state(self) -> State:
        """Fields of all particles, and the force (N, dim) on each; none beyond rank 0."""

    def grains(self) -> Mapping[str, object]:
        """The rigid bodies, as solver.protocol.Grains has them; on all ranks."""

    def totals(self) -> Mapping[str, Any]:
        """Sums over the particles, as solver.totals.Totals has them; on all ranks."""


@dataclass(frozen=True)
class Setting:
    """What surrounds a gauge in its run, SI units."""

    dim: int
    dp: float  # particle spacing
    timestep: float  # that no step is longer than
    scheme: str
    gravity: np.ndarray  # (dim,)
    periodic: tuple[int, ...]  # axes
    domain: tuple[np.ndarray, np.ndarray] | None  # lower and upper corner, where there is one
    fixed: Mapping[str, bool]  # whether the bodies of a table [body.NAME] are
    kinematics: Mapping[str, str]  # names of how they move (scenario.kinematics)
    material_names: Sequence[str]  # that the field `material` indexes
    body_names: Sequence[str]  # that the field `body` indexes
    named: Mapping[str, Sequence[str]]  # bodies that a table stands for
    support: float = 0.0  # how far a particle acts, m
    has_bodies_alone: bool = False  # no wave limits a step
    moving: frozenset[str] = frozenset()  # fixed bodies with a motion, by table
    faces: Mapping[str, FacesAt] = field(default_factory=dict)  # by table, where a body has faces

    def periods(self) -> Iterator[tuple[int, float, float]]:
        """Each periodic axis, with where the domain begins and ends along it, m."""
        if self.domain is not None:
            low, high = self.domain
            for axis in self.periodic:
                yield axis, float(low[axis]), float(high[axis])

    def is_of_material(self, material: str | None, state: State) -> np.ndarray:
        """Mask (N,) of the particles of a material; of all where it is None."""
        if material is None:
            return np.ones(len(state["material"]), bool)
        names = list(self.material_names)
        return state["material"] == (names.index(material) if material in names else -1)

    def is_of_bodies(self, tables: Sequence[str], state: State) -> np.ndarray:
        """Mask (N,) of what is of the bodies that tables [body.NAME] stand for."""
        names = self.bodies_of(tables)
        return np.isin(state["body"], [self.body_names.index(name) for name in names])

    def bodies_of(self, tables: Sequence[str]) -> list[str]:
        """The names of the bodies that tables [body.NAME] stand for."""
        return [name for table in tables for name in self.named[table]]


class Gauge(Part):
    """An instrument that is read at times of its own."""

    is_profile: ClassVar[bool] = False  # a sample has one row for each `height`
    extents: ClassVar[tuple[str, ...]] = ()  # keys of lengths within which it looks at particles

    kind: str
    interval: Duration | None = Field(None, description="s between samples; default: time_out")

    @property
    def place(self) -> np.ndarray | None:
        """The point (dim,) at which it looks, if it is a point."""
        return None

    def is_outside(self, low: np.ndarray, high: np.ndarray, gravity: np.ndarray) -> bool:
        """Whether it looks at nothing within a box, by its corners (dim,), m."""
        place = self.place
        return place is not None and bool(np.any(place < low) or np.any(place > high))

    @property
    def bandwidth(self) -> float | None:
        """Of the low-pass, Hz, that its reading goes through at each step; None: it has none."""
        return None

    @property
    def series(self) -> str | None:
        """The column by which several rows of one time are told apart; None: a row each time."""
        return None

    @property
    def has_one_row(self) -> bool:
        """Whether a sample is one row."""
        return self.series is None and not self.is_profile

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        raise NotImplementedError

    def since_start(self, dim: int) -> list[str]:
        """Its last columns, where these count from the first sample.

        `read` gives what is to be counted; what it was at the first sample is taken off.
        """
        return []

    def means(self, dim: int) -> list[str]:
        """Its last columns, where these are means since the sample before.

        `read` gives their integrals over time, since the start.
        """
        return []

    def since_before(self, dim: int) -> list[str]:
        """The columns that tell of the time since the sample before, so that the first has none."""
        return self.means(dim)

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return [name for name in self.columns(dim) if name != "time"]

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """Why it can show nothing in this setting: the key to blame, and what to say after it."""
        for key in self.extents:
            length = getattr(self, key)
            if length is not None and length < setting.dp * (1 - 1e-9):
                yield key, f" = {length:g} m is smaller than a particle, dp = {setting.dp:g} m"

    def read(self, run: Sampled, setting: Setting) -> Rows:
        """A sample: values of the columns, one row or, of a profile, several."""
        raise NotImplementedError


class FlowGauge(Gauge):
    """One that looks at what moves near a point."""

    position: Position = Field(description="where it stands, m")
    material: OptionalMaterialName = Field(
        None, description="look only at this material; default: all that moves"
    )
    array: Array | None = Field(None, description="copies; each is a gauge NAME.1, NAME.2 ...")

    @property
    def place(self) -> np.ndarray:
        """The point (dim,) at which it looks."""
        return self.position

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """It must stand inside the domain."""
        yield from super().objections(setting)
        if setting.domain is None:
            return
        low, high = setting.domain
        if np.any(self.position < low) or np.any(self.position > high):
            yield (
                "position",
                f" = {self.position.tolist()} lies outside the domain, "
                f"{low.tolist()} to {high.tolist()} m",
            )
