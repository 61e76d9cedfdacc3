"""What has gone past a plane, as over the crest of a dam, and what stands behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from ....record.particles import DRIVEN, FIXED
from ....record.units import unit_in
from ...table import Only
from ...values.directions import section_axes
from ...values.types import Direction, Length, Position
from ..gauge import Gauge, Rows, Sampled, Setting, State

SLAB = 2.0  # spacings on either side of the plane, within which particles are followed
LOOKS = 8  # steps between two looks at them: they go a fraction of the slab meanwhile
NOTHING = np.zeros(4)  # mass and volume that have passed, and those above the position


@dataclass(frozen=True)
class Beside:
    """Particles near a plane at one moment."""

    table: np.ndarray  # (n, 3 + dim): id; position, m; mass and volume, kg and m3 (2-D: per metre)

    @staticmethod
    def columns(dim: int) -> int:
        """Of the table."""
        return 3 + dim

    @property
    def id(self) -> np.ndarray:
        """Numbers (n,) that stay with them."""
        return self.table[:, 0]

    @property
    def position(self) -> np.ndarray:
        """(n, dim), m."""
        return self.table[:, 1:-2]

    @property
    def size(self) -> np.ndarray:
        """Mass and volume (n, 2), kg and m3; 2-D: per metre."""
        return self.table[:, -2:]


class Overtopping(Gauge):
    """Mass and volume that have crossed a plane, and that stand upstream of it."""

    extents: ClassVar[tuple[str, ...]] = ("width",)

    kind: Literal["overtopping"]
    position: Position = Field(
        description="a point of the plane, at the height of the crest; with `width` one of its "
        "ends, m"
    )
    direction: Direction = Field(description="normal of the plane, downstream")
    width: Annotated[Length | None, Only(dim=3)] = Field(
        None, description="3-D: of the crest, across from the position, m; default: everything"
    )

    @property
    def place(self) -> np.ndarray:
        """The point (dim,) of the plane that is given."""
        return self.position

    def is_outside(self, low: np.ndarray, high: np.ndarray, gravity: np.ndarray) -> bool:
        """Whether its plane passes beside a box; where on it the point lies does not matter but
        with a width, whose ends may both lie on one side.
        """
        across = (np.array([low, high]) - self.position) * self.normal
        beside = across.min(axis=0).sum() > 0 or across.max(axis=0).sum() < 0
        _, along = section_axes(self.normal, gravity)
        if along is not None and self.width is not None:
            ends = (np.array([low, high]) - self.position) * along
            beside |= ends.min(axis=0).sum() > self.width or ends.max(axis=0).sum() < 0
        return bool(beside)

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        mass, volume = unit_in("kg", dim), unit_in("m3", dim)
        return {
            "time": "s",
            "mass_upstream": mass,
            "volume_upstream": volume,
            "mass_supplied": mass,
            "mass_passed": mass,
            "volume_passed": volume,
            "mass_over": mass,
            "volume_over": volume,
        }

    def since_start(self, dim: int) -> list[str]:
        """What has come and passed counts from the first sample."""
        return ["mass_supplied", "mass_passed", "volume_passed", "mass_over", "volume_over"]

    def rows(self, run: Sampled, setting: Setting, plane: int, seen: np.ndarray = NOTHING) -> Rows:
        """The time, mass and volume upstream, the mass that has come there other than through the
        plane less what has left there, and mass and volume that have gone through it, and of these
        what did so above the position.

        `plane` is its number in the core, which sees every particle that crosses the whole of it;
        `seen` (4,) are the sums of what `passed_between` has found.
        """
        state, totals = run.state(), run.totals()
        away = state["position"] - self.position
        counts = _is_counted(state) & (away @ self.normal < 0)
        counts &= self._is_between_ends(away, setting)
        mass = state["mass"][counts]
        upstream, volume = float(mass.sum()), float((mass / state["density"][counts]).sum())
        passed = seen.tolist()
        supplied = upstream + passed[0]  # what is there, or went on, has come
        if self.width is None:
            supplied = totals["plane_supplied"][plane]
            passed[:2] = totals["plane_mass"][plane], totals["plane_volume"][plane]
        return [[run.time, upstream, volume, supplied, *passed]]

    def beside(self, run: Sampled, setting: Setting) -> Beside:
        """What moves near its plane now, between the ends of its crest; all ranks take part."""
        reach = np.inf if setting.has_bodies_alone else SLAB * setting.dp
        low, high = self._box(setting, reach)
        state = run.sample(low.tolist(), high.tolist())
        near = np.abs((state["position"] - self.position) @ self.normal) < reach
        some = _is_counted(state) & near
        mass, density = state["mass"][some], state["density"][some]
        fields = state["id"][some], *state["position"][some].T, mass, mass / density
        return Beside(np.column_stack(fields))

    def passed_between(self, before: Beside, now: Beside, setting: Setting) -> np.ndarray:
        """Mass and volume that have gone through between two looks, less what came back, and of
        these what did so above the position; kg and m3 (2-D: per metre).
        """
        _, i, j = np.intersect1d(before.id, now.id, assume_unique=True, return_indices=True)
        away = before.position[i] - self.position, now.position[j] - self.position
        first, last = (each @ self.normal for each in away)
        through = (first < 0) != (last < 0)
        for axis, low, high in setting.periods():  # one that goes round a period goes through none
            through &= np.abs(away[1] - away[0])[:, axis] < 0.5 * (high - low)
        first, last, j = first[through], last[through], j[through]
        share = (first / (first - last))[:, None]
        place = (1 - share) * away[0][through] + share * away[1][through]
        sign = np.where(last < 0, -1.0, 1.0) * self._is_between_ends(place, setting)
        up, _ = section_axes(self.normal, setting.gravity)
        over = place @ up >= 0
        passed = sign[:, None] * now.size[j]
        return np.concatenate([passed.sum(axis=0), over @ passed])

    @property
    def normal(self) -> np.ndarray:
        """Of length 1, (dim,)."""
        return np.asarray(self.direction / np.linalg.norm(self.direction))

    def _is_between_ends(self, away: np.ndarray, setting: Setting) -> np.ndarray:
        """Mask (n,) of what is, away from the position (n, dim), m, between the ends of a crest."""
        _, across = section_axes(self.normal, setting.gravity)
        if across is None or self.width is None:
            return np.ones(len(away), bool)
        along = away @ across
        return np.asarray((along >= 0) & (along < self.width))

    def _box(self, setting: Setting, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Corners (dim,) of a box around what is that near to the plane between the ends, m."""
        up, across = section_axes(self.normal, setting.gravity)
        free = np.abs(up) > 1e-9
        ends = self.position[None, :]
        if across is not None and self.width is None:
            free |= np.abs(across) > 1e-9
        elif across is not None:
            ends = self.position + np.outer([0.0, self.width], across)
        low, high = ends.min(axis=0) - reach, ends.max(axis=0) + reach
        return np.where(free, -np.inf, low), np.where(free, np.inf, high)


def _is_counted(state: State) -> np.ndarray:
    return np.asarray((state["motion"] != FIXED) & (state["motion"] != DRIVEN))
