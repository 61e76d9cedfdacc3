"""Bodies that move: a point for each, and polygons of those that are no balls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...record.fields import GRAIN_FIELDS
from ...record.reader import Snapshot
from ...scenario.model import Scenario
from ...scene.kinds.registry import bodies_of
from ...scene.shapes import Ball, Shape
from ..polydata import PolyData, in_space
from .shapes import joined, placed, polygons_of

BALL_DIAMETER = "BallDiameter"


@dataclass(frozen=True)
class GrainShapes:
    """The shape of each row of a snapshot's table of bodies; None: a ball of its diameter."""

    shapes: list[Shape | None]
    bends: frozenset[int] = frozenset()  # rows that have none: their particles show them

    def is_ball(self, row: int) -> bool:
        """Whether a row is one; what came off a body that broke has no shape of its own."""
        return row < len(self.shapes) and self.shapes[row] is None and row not in self.bends

    @property
    def has_others(self) -> bool:
        """Whether any is no ball."""
        return any(shape is not None for shape in self.shapes)


def grain_shapes(scenario: Scenario, snapshot: Snapshot) -> tuple[GrainShapes, list[str]]:
    """Shapes of the bodies that move, and the names of tables that do not tell them.

    Of a table from which bodies have left before the first snapshot nobody knows which ones.
    """
    names = snapshot.grains.get("body", np.zeros(0, str))
    shapes: list[Shape | None] = [None] * len(names)
    unknown = set(names.tolist())
    bends: set[int] = set()
    for name, body in bodies_of(scenario).items():
        rows = np.flatnonzero(names == name)
        if not len(rows) or not body.is_of_bodies:
            continue
        group = body.group()
        if len(group) != len(rows) and not group.deforms:
            continue
        unknown.discard(name)
        if group.deforms:
            bends.update(rows.tolist())
            continue
        for row, which in zip(rows, group.shape, strict=True):
            shape = group.shapes[which]
            shapes[row] = None if isinstance(shape, Ball) else shape
    return GrainShapes(shapes, frozenset(bends)), sorted(unknown)


def grain_points(snapshot: Snapshot, known: GrainShapes) -> PolyData:
    """A point for each body that is in the run, with the columns of its table."""
    table = snapshot.grains
    there = np.flatnonzero(table["removed"] == 0)
    fields, units = {}, {}
    for column in GRAIN_FIELDS:
        if column.key in ("position", "removed"):
            continue
        values = table[column.key][there]
        if column.key == "body":
            values = indices(snapshot, values)
        fields[column.file_name] = in_space(values) if column.shape == "vector" else values
        units[column.file_name] = column.unit_in(snapshot.dim)
    ball = np.array([known.is_ball(k) for k in there.tolist()], bool)
    fields[BALL_DIAMETER] = np.where(ball, table["diameter"][there], 0.0)
    fields["Grain"] = there
    return PolyData(
        table["position"][there],
        verts=np.arange(len(there))[:, None],
        fields=fields,
        units=units | {BALL_DIAMETER: "m"},
        strings={"BodyNames": snapshot.body_names},
        time=snapshot.time,
    )


def grain_polygons(snapshot: Snapshot, known: GrainShapes) -> PolyData:
    """The surfaces of the bodies that are no balls, with the velocity of their points."""
    table, parts, rows = snapshot.grains, [], []
    for row, shape in enumerate(known.shapes):
        if shape is None or table["removed"][row]:
            continue
        own = polygons_of(shape)
        parts.append(placed(own, table["position"][row], table["orientation"][row]))
        rows.append(row)
    points, faces, owner = joined(parts, snapshot.dim)
    number = np.array(rows, np.int64)
    of_point = np.repeat(number, [len(part.points) for part in parts])
    arm = in_space(points - table["position"][of_point])
    velocity = in_space(table["velocity"][of_point]) + np.cross(table["spin"][of_point], arm)
    return PolyData(
        points,
        polys=faces,
        fields={"Velocity": velocity},
        cell_fields={
            "Grain": number[owner],
            "Body": indices(snapshot, table["body"][number[owner]]),
        },
        units={"Velocity": "m/s"},
        strings={"BodyNames": snapshot.body_names},
        time=snapshot.time,
    )


def indices(snapshot: Snapshot, names: np.ndarray) -> np.ndarray:
    """Indices (n,) of names of bodies, as particles have them."""
    number = {name: k for k, name in enumerate(snapshot.body_names)}
    return np.array([number[str(name)] for name in names], np.int32)
