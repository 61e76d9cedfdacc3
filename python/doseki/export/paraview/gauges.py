"""Where gauges look: points, lines and faces with their names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...geodata.ground import Profile
from ...geodata.raster import Raster
from ...scenario.model import Scenario
from ...scenario.values.directions import section_axes, upwards
from ..polydata import PolyData

ALONG = 41  # points of a line on the ground

Top = Callable[[str], np.ndarray | None]


@dataclass
class Marks:
    """Points (dim,), m, and cells of them by the number of their corners: 1, 2 and more, 4."""

    dim: int
    points: list[np.ndarray] = field(default_factory=list)
    verts: list[tuple[np.ndarray, str, str]] = field(default_factory=list)
    lines: list[tuple[np.ndarray, str, str]] = field(default_factory=list)
    faces: list[tuple[np.ndarray, str, str]] = field(default_factory=list)
    labels: dict[str, list[float]] = field(default_factory=dict)

    def add(self, name: str, kind: str, points: np.ndarray, closed: bool = False) -> None:
        """Mark a point, a line through points (n, dim), or the face around them."""
        number = len(self.points) + np.arange(len(points))
        self.points.extend(points)
        cells = self.faces if closed else self.verts if len(points) == 1 else self.lines
        cells.append((number, name, kind))
        middle = np.mean(points, axis=0) if closed else points[len(points) // 2]
        self.labels.setdefault(name, [*map(float, middle), *[0.0] * (3 - self.dim)])

    def polydata(self) -> PolyData:
        """The marks with the name and kind of the gauge of each cell."""
        cells = [*self.verts, *self.lines, *self.faces]
        return PolyData(
            np.array(self.points).reshape(-1, self.dim),
            verts=[cell for cell, _, _ in self.verts],
            lines=[cell for cell, _, _ in self.lines],
            polys=[cell for cell, _, _ in self.faces],
            names={"Gauge": [name for _, name, _ in cells], "Kind": [k for _, _, k in cells]},
        )


def gauge_marks(
    scenario: Scenario, ground: Raster | Profile | None, top: Top
) -> tuple[Marks, list[str]]:
    """Where the gauges of a run look, and the names of those that look at no place.

    `top` gives that of a fixed body, which gauges of forces are about.
    """
    marks, nowhere = Marks(scenario.dim), []
    for name, gauge in scenario.gauge.items():
        if not getattr(gauge, "enabled", True):
            continue
        has_place = _mark(marks, name, gauge, scenario, ground)
        if not has_place and not _bodies(marks, name, gauge, top):
            nowhere.append(name)
    return marks, nowhere


def _mark(
    marks: Marks, name: str, gauge: Any, scenario: Scenario, ground: Raster | Profile | None
) -> bool:
    """Mark a gauge that has a place of its own; what it has is told by its keys."""
    kind, has = gauge.kind, _given(gauge)
    if "left" in has and "right" in has:
        marks.add(name, kind, _on_ground(np.asarray([has["left"], has["right"]]), ground))
    elif "origin" in has and "edges" in has:
        _panels(marks, name, kind, has)
    elif "position" in has:
        _section(marks, name, kind, has, scenario)
    else:
        return False
    return True


def _given(gauge: Any) -> Mapping[str, Any]:
    keys = ("left", "right", "origin", "edges", "panels", "position", "direction", "depth",
            "width", "length", "count")  # fmt: skip
    found = {key: getattr(gauge, key, None) for key in keys}
    return {key: value for key, value in found.items() if value is not None}


def _panels(marks: Marks, name: str, kind: str, has: Mapping[str, Any]) -> None:
    """Each panel; in 2-D a line."""
    origin, edges = np.asarray(has["origin"], float), np.asarray(has["edges"], float)
    steps = [edge / count for edge, count in zip(edges, has["panels"], strict=True)]
    for place in np.ndindex(*has["panels"]):
        corner = origin + sum(k * step for k, step in zip(place, steps, strict=True))
        if len(steps) == 1:
            marks.add(name, kind, np.array([corner, corner + steps[0]]))
        else:
            a, b = steps
            marks.add(name, kind, np.array([corner, corner + a, corner + a + b, corner + b]), True)


def _section(
    marks: Marks, name: str, kind: str, has: Mapping[str, Any], scenario: Scenario
) -> None:
    """A point, and how far up or across from it the gauge looks, where it says so."""
    place = np.asarray(has["position"], float)
    marks.add(name, kind, place[None, :])
    if "count" in has and "length" in has:  # a profile
        up = upwards(scenario.gravity, has.get("direction"))
        marks.add(name, kind, np.array([place, place + has["length"] * up]))
        return
    if "direction" not in has or not {"depth", "width"} & set(has):
        return
    normal = np.asarray(has["direction"], float)
    up, across = section_axes(normal / np.linalg.norm(normal), scenario.gravity)
    sides = [
        extent * axis
        for axis, extent in ((up, has.get("depth")), (across, has.get("width")))
        if axis is not None and extent is not None
    ]
    if len(sides) == 2:
        a, b = sides
        marks.add(name, kind, np.array([place, place + a, place + a + b, place + b]), True)
    else:
        marks.add(name, kind, np.array([place, place + sides[0]]))


def _on_ground(ends: np.ndarray, ground: Raster | Profile | None) -> np.ndarray:
    """Points (n, 3) on the ground below a line on the map, or at zero without one."""
    share = np.linspace(0, 1, ALONG)[:, None]
    places = ends[0] + share * (ends[1] - ends[0])
    height = np.zeros(ALONG)
    if isinstance(ground, Raster):
        height = ground.sampled(places[:, 0], places[:, 1])
        known = np.isfinite(height)
        if not known.any():
            height, known = np.zeros(ALONG), np.ones(ALONG, bool)
        places, height = places[known], height[known]
    return np.column_stack([places, height])


def _bodies(marks: Marks, name: str, gauge: Any, top: Top) -> bool:
    """Mark the fixed bodies on which a gauge reads loads."""
    found = [top(body) for body in getattr(gauge, "bodies", None) or ()]
    places = [place for place in found if place is not None]
    for place in places:
        marks.add(name, gauge.kind, place[None, :])
    return bool(places)
