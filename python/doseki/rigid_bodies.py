"""The rigid bodies of a run, as the core reads them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .elastic_bodies import ElasticBody, add_elastic_bodies
from .fields import GRAIN_FIELDS
from .grains import Group
from .scenario import Scenario


@dataclass(frozen=True)
class Bodies:
    """Bodies that move (first) and fixed ones that they touch; none where nothing moves.

    For each particle: `grain`, the index of its body or -1, and for those of bodies the outward
    `normal` and the `depth` below the surface, m; `shaped` tells which particles have these.
    """

    groups: list[Group]
    velocity: np.ndarray  # (n, dim) m/s, of all bodies in order
    spin: np.ndarray  # (n, 3) rad/s
    grain: np.ndarray  # (N,) int32
    shaped: np.ndarray  # (N,) bool
    normal: np.ndarray  # (N, dim)
    depth: np.ndarray  # (N,)
    elastic: list[ElasticBody] = field(default_factory=list)  # deformable ones, not in `groups`

    def __len__(self) -> int:
        return sum(len(group) for group in self.groups)


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
    table = {key: np.ascontiguousarray(np.concatenate(v)) for key, v in columns.items()}
    return shapes, table | {"velocity": bodies.velocity, "spin": bodies.spin}


def _columns(
    scenario: Scenario, group: Group, names: list[str], first_shape: int
) -> dict[str, np.ndarray]:
    n, rho0 = len(group), scenario.materials[group.material].rho0
    mass = rho0 * np.array([shape.measure for shape in group.shapes])[group.shape]
    gyration = np.array([shape.inertia for shape in group.shapes])[group.shape]
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


def add_bodies(simulation: Any, scenario: Scenario, bodies: Bodies, names: list[str]) -> None:
    """Hand bodies over to the core, after the particles; nothing where nothing moves."""
    if len(bodies):
        shapes, table = rigid_tables(scenario, bodies, names)
        simulation.add_shapes(shapes)
        simulation.add_rigid_bodies(table)
        simulation.bind_points(np.ascontiguousarray(bodies.grain, np.int32))
    add_elastic_bodies(simulation, scenario, bodies.elastic)


def grain_table(simulation: Any) -> dict[str, np.ndarray]:
    """The bodies that move as fields.GRAIN_FIELDS has them; empty where there are none."""
    table = {key: np.asarray(values) for key, values in simulation.grains().items()}
    moves = ~table["fixed"]
    if not moves.any():
        return {}
    table |= {"position": table["centre"], "diameter": 2 * table["radius"]}
    return {field.key: table[field.key][moves] for field in GRAIN_FIELDS}
