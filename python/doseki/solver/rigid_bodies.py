"""The rigid bodies of a run, as the core reads them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..record.fields import GRAIN_FIELDS
from ..scenario.model import Scenario
from ..scenario.tables.terrain.terrain import TERRAIN
from ..scene.bodies import Bodies
from ..scene.groups import UPRIGHT, Group
from ..scene.shapes import MeshShape, Shape
from .elastic_bodies import add_elastic_bodies
from .placed import origin_of
from .protocol import CoreSimulation, Simulation

AS_ALIKE = 1e-12  # moments of inertia that differ by less are those of a ball


def rigid_tables(
    scenario: Scenario, bodies: Bodies, names: list[str]
) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """The arguments of the core's add_shapes and add_rigid_bodies."""
    shapes: list[dict[str, Any]] = []
    columns: dict[str, list[np.ndarray]] = {}
    for group in bodies.groups:
        for key, values in _columns(scenario, group, names, len(shapes)).items():
            columns.setdefault(key, []).append(values)
        shapes += [shape.table(scenario.dp) for shape in group.shapes]
    velocity, spin = bodies.velocity, bodies.spin
    if scenario.bed is not None:
        for key, values in _ground_columns(scenario, names, len(shapes)).items():
            columns.setdefault(key, []).append(values)
        shapes.append({"radius": 1.0, "ground": True})
        velocity, spin = np.pad(velocity, ((0, 1), (0, 0))), np.pad(spin, ((0, 1), (0, 0)))
    table = {key: np.ascontiguousarray(np.concatenate(v)) for key, v in columns.items()}
    return shapes, table | {"velocity": velocity, "spin": spin}


def _ground_columns(scenario: Scenario, names: list[str], shape: int) -> dict[str, np.ndarray]:
    """The terrain as a fixed body, whose frame is that of the core."""
    assert scenario.terrain is not None
    return {
        "shape": np.full(1, shape, np.int32),
        "centre": origin_of(scenario)[None, :],
        "orientation": UPRIGHT[None, :],
        "mass": np.ones(1),
        "inertia": np.eye(3)[None, :, :],
        "material": np.full(1, scenario.material_names.index(scenario.terrain.material), np.int32),
        "body": np.full(1, names.index(TERRAIN), np.int32),
        "fixed": np.full(1, True),
    }


def _columns(
    scenario: Scenario, group: Group, names: list[str], first_shape: int
) -> dict[str, np.ndarray]:
    table = scenario.body.get(group.name)
    spacing = (table.given("dp") if table is not None else None) or scenario.dp
    n, rho0 = len(group), scenario.materials[group.material].rho0
    mass = rho0 * group.measures[0]
    gyration = np.array([_gyration(group, shape, spacing) for shape in group.shapes])[group.shape]
    return {
        "shape": (first_shape + group.shape).astype(np.int32),
        "centre": group.centre,
        "orientation": group.orientation,
        "mass": mass,
        "inertia": mass[:, None, None] * gyration,
        "material": np.full(n, scenario.material_names.index(group.material), np.int32),
        "body": np.full(n, names.index(group.name), np.int32),
        "fixed": np.full(n, group.fixed),
    }


def _gyration(group: Group, shape: Shape, spacing: float) -> np.ndarray:
    """Inertia tensor (3, 3) over the mass, m2, in the frame of the shape.

    That of the points where a body may become deformable, so that nothing jumps when it does.
    """
    if not group.breakable or isinstance(shape, MeshShape):
        return shape.inertia
    points = shape.elastic_particles(spacing).position
    arm = np.pad(points - points.mean(axis=0), ((0, 0), (0, 3 - points.shape[1])))
    square = (arm**2).sum(axis=1).mean()
    found = square * np.eye(3) - arm.T @ arm / len(arm)
    if points.shape[1] == 2:
        return np.diag([0, 0, found[2, 2]])
    mean = np.trace(found) / 3 * np.eye(3)  # of balls and cubes, to rounding
    alike = np.abs(found - mean).max() < AS_ALIKE * square
    return np.asarray(mean if alike else found)


def add_bodies(
    simulation: CoreSimulation, scenario: Scenario, bodies: Bodies, names: list[str]
) -> None:
    """Hand bodies over to the core, after the particles; nothing where nothing moves."""
    if len(bodies) or (bodies.elastic and scenario.bed is not None):
        shapes, table = rigid_tables(scenario, bodies, names)
        simulation.add_shapes(shapes)
        simulation.add_rigid_bodies(table)
        simulation.bind_points(np.ascontiguousarray(bodies.grain, np.int32))
    add_elastic_bodies(simulation, scenario, bodies.elastic)


def grain_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """The bodies that move as fields.GRAIN_FIELDS has them, row k that of number k.

    These are rigid bodies, and deformable ones that may break with their parts; empty where there
    are none.
    """
    tables: list[Mapping[str, Any]] = [
        {key: np.asarray(values) for key, values in table.items()}
        for table in (simulation.grains(), simulation.fragments())
    ]
    number = np.concatenate([table["number"] for table in tables])
    order = np.argsort(number, kind="stable")[np.count_nonzero(number < 0) :]
    if not len(order):
        return {}
    renamed = {"position": "centre", "diameter": "radius"}
    columns = {
        field.key: np.concatenate([table[renamed.get(field.key, field.key)] for table in tables])
        for field in GRAIN_FIELDS
    }
    columns["diameter"] = 2 * columns["diameter"]
    return {key: values[order] for key, values in columns.items()}
