"""What does not move by itself: fixed bodies with a shape, and the ground."""

from __future__ import annotations

import math

import numpy as np

from ...geodata.ground import Profile
from ...geodata.raster import Raster
from ...scenario.model import Scenario
from ...scenario.values.directions import upwards
from ...scene.groups import Group
from ...scene.kinds.registry import bodies_of
from ...scene.moved import Displacement, is_gone
from ..polydata import PolyData
from .shapes import MANY, joined, placed, polygons_of

MOST_NODES = 1000  # of the ground, along a side


class Structures:
    """The fixed bodies of a scenario whose shape is known."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._groups: dict[str, Group] = {}
        for name, body in bodies_of(scenario).items():
            group = body.group() if body.is_of_bodies else body.contact_shape()
            if group is not None and group.fixed:
                self._groups[name] = group

    @property
    def names(self) -> list[str]:
        """Of the tables [body.NAME] that are shown."""
        return list(self._groups)

    @property
    def move(self) -> bool:
        """Whether any of them moves or is removed, as is prescribed."""
        body = self._scenario.body
        return any(body[name].prescribed_motion is not None for name in self._groups)

    def at(self, time: float) -> PolyData:
        """Their surfaces at a time, s."""
        parts, numbers = [], []
        for number, (name, group) in enumerate(self._groups.items()):
            if is_gone(self._scenario, name, time):
                continue
            stands = Displacement(self._scenario, name, time).group(group)
            shapes = [polygons_of(shape, len(group) > MANY) for shape in group.shapes]
            for k, which in enumerate(group.shape):
                parts.append(placed(shapes[which], stands.centre[k], stands.orientation[k]))
                numbers.append(number)
        points, faces, owner = joined(parts, self._scenario.dim)
        return PolyData(
            points,
            polys=faces,
            cell_fields={"Structure": np.array(numbers, np.int32)[owner]},
            strings={"StructureNames": self.names},
            time=time if self.move else None,
        )

    def top(self, name: str) -> np.ndarray | None:
        """The highest point above the middle of what a table shows at the start (dim,), m.

        None where it shows nothing.
        """
        group = self._groups.get(name)
        if group is None:
            return None
        up = upwards(np.asarray(self._scenario.gravity))
        middle = group.centre.mean(axis=0)
        shapes = [polygons_of(shape, True) for shape in group.shapes]
        heights = [
            (placed(shapes[which], centre, turn).points @ up).max()
            for which, centre, turn in zip(
                group.shape, group.centre, group.orientation, strict=True
            )
        ]
        return np.asarray(middle + (max(heights) - middle @ up) * up)


def ground_surface(ground: Raster | Profile) -> PolyData:
    """The ground as squares between its nodes, or in 2-D as a line.

    Of a raster with more than MOST_NODES along a side every second node is taken, or every third.
    """
    if isinstance(ground, Profile):
        points = np.stack([ground.x, ground.z], axis=1)
        return PolyData(points, lines=[np.arange(len(points))])
    step = math.ceil(max(ground.values.shape) / MOST_NODES)
    height = ground.values[::step, ::step]
    x, y = np.meshgrid(ground.x[::step], ground.y[::step])
    number = np.arange(height.size).reshape(height.shape)
    # Anticlockwise seen from above; rows go from north to south.
    corners = number[1:, :-1], number[1:, 1:], number[:-1, 1:], number[:-1, :-1]
    faces = np.stack([corner.ravel() for corner in corners], axis=1)
    known = np.isfinite(height).ravel()
    faces = faces[known[faces].all(axis=1)]
    used, own = np.unique(faces, return_inverse=True)
    points = np.stack([x.ravel(), y.ravel(), height.ravel()], axis=1)[used]
    return PolyData(
        points,
        polys=own.reshape(faces.shape),
        fields={"Height": points[:, 2].copy()},
        units={"Height": "m"},
    )
