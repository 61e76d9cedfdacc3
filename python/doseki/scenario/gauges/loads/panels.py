"""Pressures on the panels of a face."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ....record.particles import FIXED
from ...values.types import BodyNames, Direction, Position, Vector
from ...values.units import LENGTH, Measured
from ..gauge import Rows, Setting, State
from .metered import Metered, Row

MAX_PANELS = 10_000
SQUARE = 1e-6  # cosine between edges that are at right angles
FACING = 0.5  # least cosine between the normal of a wall particle and that of the face
ALONG = 0.1  # cosine between the normal and a direction that lies in the face

Count = Annotated[int, Field(ge=1, le=MAX_PANELS)]
Edge = Annotated[Vector, Measured(LENGTH)]


class Panels(Metered):
    """Normal pressure of flow and contacts on each panel of a plane face."""

    kind: Literal["panels"]
    bodies: BodyNames = Field(description="names of fixed bodies")
    origin: Position = Field(description="a corner of the face, on its surface, m")
    edges: list[Edge] = Field(
        description="from that corner, m: one in 2-D, two at right angles in 3-D"
    )
    panels: list[Count] = Field(description="along each edge")
    direction: Direction = Field(description="from the face into the flow")

    @property
    def series(self) -> str:
        """The column by which rows of one time are told apart."""
        return "panel"

    def columns(self, dim: int) -> dict[str, str]:
        """Name and unit of each column of its file."""
        places = {"panel": "1"} | dict.fromkeys(["along_1", "along_2"][: dim - 1], "m")
        return {"time": "s"} | places | dict.fromkeys(self.means(dim), "Pa")

    def means(self, dim: int) -> list[str]:
        """The columns that are means since the sample before."""
        return ["flow_pressure", "contact_pressure"]

    def curves(self, dim: int) -> list[str]:
        """The columns that a figure draws where none are named."""
        return self.means(dim)

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """Its edges must span a face of the run."""
        yield from super().objections(setting)
        faces = setting.dim - 1
        for key, values in (("edges", self.edges), ("panels", self.panels)):
            if len(values) != faces:
                yield key, f": a {setting.dim}-D run needs {faces} here, not {len(values)}"
                return
        lengths = [float(np.linalg.norm(edge)) for edge in self.edges]
        if min(lengths) == 0.0:
            yield "edges", ": an edge has no length"
            return
        if faces == 2:
            cosine = float(self.edges[0] @ self.edges[1]) / (lengths[0] * lengths[1])
            if abs(cosine) > SQUARE:
                yield "edges", f": must be at right angles; their cosine is {cosine:.3g}"
        if np.prod(self.panels) > MAX_PANELS:
            yield "panels", f" = {self.panels}: {np.prod(self.panels)}, at most {MAX_PANELS}"
        for length, count in zip(lengths, self.panels, strict=True):
            if length / count < setting.dp * (1 - 1e-9):
                yield (
                    "panels",
                    f" = {self.panels}: a panel of {length / count:.3g} m is smaller than a "
                    f"particle, dp = {setting.dp:g} m",
                )
        straight = float(self.normal @ self.direction / np.linalg.norm(self.direction))
        if straight < ALONG:
            yield "direction", f" = {self.direction.tolist()} lies in the face; it points out of it"
        for name in self.bodies:
            if name in setting.moving:
                yield "bodies", f': "{name}" moves, the panels stand still'

    @property
    def size(self) -> np.ndarray:
        """Of a panel along each edge (dim - 1,), m."""
        lengths = [float(np.linalg.norm(edge)) for edge in self.edges]
        return np.array(lengths) / self.panels

    @property
    def normal(self) -> np.ndarray:
        """Unit normal (dim,) of the face, into the flow."""
        if len(self.edges) == 1:
            normal = np.array([-self.edges[0][1], self.edges[0][0]])
        else:
            normal = np.cross(self.edges[0], self.edges[1])
        side = 1.0 if normal @ self.direction >= 0 else -1.0
        return np.asarray(side * normal / np.linalg.norm(normal))

    def first_row(self, state: State, setting: Setting) -> np.ndarray:
        """Mask (N,) of the wall particles right below the plane of the face."""
        first_row = (state["motion"] == FIXED) & (state["depth"] < setting.dp)
        first_row &= setting.is_of_bodies(self.bodies, state)
        place = state["position"] + state["depth"][:, None] * state["normal"]
        first_row &= np.abs((place - self.origin) @ self.normal) < 0.5 * setting.dp
        return np.asarray(first_row & (state["normal"] @ self.normal > FACING))

    def covered(self, state: State, setting: Setting) -> np.ndarray:
        """How much (panels,) of each panel is wall, from the wall particles of the run."""
        flat = self.first_row(state, setting)
        away = state["position"] - self.origin
        covered = np.ones((int(flat.sum()), 1))
        for edge, size, count in zip(self.edges, self.size, self.panels, strict=True):
            along = (away[flat] @ edge / np.linalg.norm(edge))[:, None]
            ends = size * np.arange(count + 1)
            upper = np.minimum(along + 0.5 * setting.dp, ends[1:])
            part = np.maximum(0.0, upper - np.maximum(along - 0.5 * setting.dp, ends[:-1])) / size
            covered = (part[:, :, None] * covered[:, None, :]).reshape(
                len(part), count * covered.shape[1]
            )
        return covered.sum(axis=0)

    def meter(self, setting: Setting) -> dict[str, object]:
        """The table of the core's add_load_meter."""
        units = [(edge / np.linalg.norm(edge)).tolist() for edge in self.edges]
        return super().meter(setting) | {
            "origin": self.origin.tolist(),
            "edges": units,
            "normal": self.normal.tolist(),
            "size": self.size.tolist(),
            "count": list(self.panels),
            "footprint": setting.dp,
            "reach": setting.support,
        }

    def rows(self, time: float, row: Row) -> Rows:
        """A row for each panel: its middle, and the impulses per area, Pa s, since the start."""
        size = self.size
        area = float(np.prod(size))
        result = []
        for panel, pressed in enumerate(zip(row["panel_flow"], row["panel_contact"], strict=True)):
            second, first = divmod(panel, self.panels[0])
            middle = (np.array([first, second][: len(size)]) + 0.5) * size
            result.append([time, float(panel), *middle, *(float(each) / area for each in pressed)])
        return result
