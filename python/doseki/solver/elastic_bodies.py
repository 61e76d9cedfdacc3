"""The deformable bodies of a run, as the core reads them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..scenario.materials import ELASTIC_DEFAULTS, FRACTURES, Material
from ..scenario.model import Scenario
from ..scene.bodies import ElasticBody
from .protocol import CoreSimulation


def fracture_table(material: Material) -> dict[str, Any]:
    """How a material breaks: the law and its parameters."""
    law = FRACTURES[material.fracture]
    numbers = {p.name: material.of_laws[p.name] for p in law.parameters}
    return {"fracture": law.name, **numbers}


def elastic_table(scenario: Scenario, body: ElasticBody) -> dict[str, Any]:
    """The argument of the core's add_elastic_body."""
    table = scenario.body[body.name]
    material = scenario.materials[body.material]
    modulus, ratio = material.elasticity
    given = {key: table.given(key) for key in ELASTIC_DEFAULTS}
    chosen = ELASTIC_DEFAULTS | {key: value for key, value in given.items() if value is not None}
    return (
        chosen
        | fracture_table(material)
        | {
            "material": scenario.material_names.index(body.material),
            "rho0": material.rho0,
            "young_modulus": modulus,
            "poisson_ratio": ratio,
            "spacing": body.spacing,
            "particles": np.ascontiguousarray(body.members, np.int32),
            "rest": np.ascontiguousarray(body.rest),
            "position": np.ascontiguousarray(body.position),
            "velocity": np.ascontiguousarray(body.velocity),
            "clamped": np.ascontiguousarray(body.clamped, np.uint8),
            "vertex": np.ascontiguousarray(body.surface.vertex),
            "carrier": np.ascontiguousarray(body.surface.carrier, np.int32),
            "crease": np.ascontiguousarray(body.surface.crease, np.uint8),
            "outward": np.ascontiguousarray(body.surface.outward),
            "share": np.ascontiguousarray(body.surface.share),
            "radius": np.ascontiguousarray(body.surface.radius),
            "cell_count": body.cells.count,
            "cell_node": body.cells.node,
            "rigid_first": body.rigid_first,
        }
    )


def add_elastic_bodies(
    simulation: CoreSimulation, scenario: Scenario, bodies: list[ElasticBody]
) -> None:
    """Hand deformable bodies over to the core, after the particles and their normals."""
    for body in bodies:
        simulation.add_elastic_body(elastic_table(scenario, body))
