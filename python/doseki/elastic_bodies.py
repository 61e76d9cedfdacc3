"""Deformable bodies of a run: which particles they are made of, as the core reads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .scenario import Scenario

LEAST_ACROSS = 2  # particles; fewer do not span a body
ELASTIC_KEYS = ("clamped", "damping", "elastic_law", "hourglass")  # of deformable bodies alone


@dataclass(frozen=True)
class ElasticBody:
    """One deformable body: n of the particles of a run."""

    name: str  # of its table
    members: np.ndarray  # (n,) int32, indices of particles
    spacing: float  # each particle has spacing^dim of its volume, m
    clamped: np.ndarray  # (n,) bool: does not move
    surface: np.ndarray  # (n,) bool: touches other bodies


def is_elastic(body: Any) -> bool:
    """Whether [body.NAME] is deformable."""
    return getattr(body, "kinematics", None) == "elastic"


def elastic_table(scenario: Scenario, body: ElasticBody) -> dict[str, Any]:
    """The argument of the core's add_elastic_body."""
    table = scenario.body[body.name]
    material = scenario.materials[table.material]
    modulus, ratio = material.elasticity
    given = {"law": table.elastic_law, "damping": table.damping, "hourglass": table.hourglass}
    return {key: value for key, value in given.items() if value is not None} | {
        "material": scenario.material_names.index(table.material),
        "rho0": material.rho0,
        "young_modulus": modulus,
        "poisson_ratio": ratio,
        "spacing": body.spacing,
        "particles": np.ascontiguousarray(body.members, np.int32),
        "clamped": np.ascontiguousarray(body.clamped, np.uint8),
        "surface": np.ascontiguousarray(body.surface, np.uint8),
    }


def add_elastic_bodies(simulation: Any, scenario: Scenario, bodies: list[ElasticBody]) -> None:
    """Hand deformable bodies over to the core, after the particles and their normals."""
    for body in bodies:
        simulation.add_elastic_body(elastic_table(scenario, body))
