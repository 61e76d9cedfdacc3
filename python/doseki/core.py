"""A simulation of the compiled core, made from a scenario."""

from __future__ import annotations

from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np

from .bodies import build_scene
from .core_modules import available_instruction_sets, load_core
from .inflows import InflowSection, build_inflows
from .motions import wall_motions
from .rigid_bodies import add_bodies
from .scenario import Scenario, min_sound_speed
from .schemes import RESOLVED
from .settling import settled
from .walls import wall_geometry

__all__ = ["available_instruction_sets", "build_simulation", "load_core"]

# Margin of the first lists of a run that chooses its own.
FIRST_SKIN = 0.05
# Of contacts while grains settle: restitution and steps at most.
CALM, CALM_STEPS = 0.2, 12
STRENGTH = ("shear_modulus", "yield_strength", "cohesion", "friction_angle")


def core_options(scenario: Scenario, body_names: list[str]) -> dict[str, Any]:
    """The parameters of the scheme, as the core reads them."""
    names = "attraction eta alpha cflnumber cfl_force fixed_limits_dt balsara sym_grad".split()
    names += ["tension", "h_mode"]
    axes = "xyz"[: scenario.dim]
    zeros = [0.0] * scenario.dim
    low, high = scenario.domain_min, scenario.domain_max
    flow: dict[str, Any] = {}
    if scenario.scheme == RESOLVED:
        flow = {"flow": _flow_options(scenario, body_names), "contact": _contact_options(scenario)}
    return (
        flow
        | {name: getattr(scenario, name) for name in names}
        | {
            "gravity": list(scenario.gravity),
            "skin": FIRST_SKIN if scenario.skin == "auto" else scenario.skin,
            "auto_skin": scenario.skin == "auto",
            "periodic": [axis in scenario.periodic for axis in axes],
            "domain_min": zeros if low is None else list(low),
            "domain_max": zeros if high is None else list(high),
        }
    )


def _flow_options(scenario: Scenario, body_names: list[str]) -> dict[str, Any]:
    """What only the resolved scheme has."""
    names = "dp kernel viscosity shifting eos turbulence smagorinsky".split()
    return {name: getattr(scenario, name) for name in names} | {
        "walls": [_wall_condition(scenario.body.get(name)) for name in body_names]
    }


def _contact_options(scenario: Scenario) -> dict[str, Any]:
    """How bodies touch; the speed to expect is a tenth of the sound speed of the run."""
    options = scenario.contact.model_dump()
    if options["speed"] is None:
        options["speed"] = 0.1 * scenario.xi * min_sound_speed(scenario)
    return options


def _wall_condition(body: Any) -> dict[str, Any]:
    wall = getattr(body, "wall", "no_slip")
    return {"stick": wall == "no_slip", "ks": body.ks if wall == "rough" else 0.0}


def core_materials(scenario: Scenario) -> list[dict[str, Any]]:
    """Materials in the order of their indices, scaled by xi; no strength where none is evolved."""
    tables = []
    moving = _moving_materials(scenario)
    for name in scenario.material_names:
        material = scenario.materials[name]
        table = asdict(material.scaled(scenario.xi))
        table["young_modulus"], table["poisson_ratio"] = material.elasticity
        if not scenario.strength or name not in moving:
            table |= dict.fromkeys(STRENGTH, 0.0)
        tables.append(table)
    return tables


def _moving_materials(scenario: Scenario) -> set[str]:
    """Materials of what can move: fixed particles have no deviatoric stress."""
    moving = {inflow.material for inflow in scenario.inflow.values()}
    for name, body in scenario.body.items():
        table = scenario.particle_tables.get(name)
        if table is not None:
            moving |= set(table.material_names)
        elif not body.fixed:
            moving.add(body.material)
    return moving


def _inflow_table(section: InflowSection) -> dict[str, Any]:
    return {
        "layer": [list(row) for row in section.rows],
        "direction": list(section.direction),
        **{
            name: getattr(section, name)
            for name in "spacing jitter mass density smoothing_length".split()
        },
        **{name: getattr(section, name).tolist() for name in "times speeds distances".split()},
        "buffer_layers": int(section.buffer_layers),
        "material": int(section.material),
        "body": int(section.body),
    }


def _kind(scenario: Scenario, isa: str | None) -> Any:
    """The class of core simulations that `scenario` needs."""
    scheme = "Resolved" if scenario.scheme == RESOLVED else ""
    name = f"{scheme}Simulation{scenario.dim}{scenario.precision.capitalize()}"
    return getattr(load_core(isa), name)


def _dry_simulation(scenario: Scenario, body_names: list[str], isa: str | None = None) -> Any:
    """For grains that settle: where they come to rest is wanted, not how they bounce before."""
    materials, options = core_materials(scenario), core_options(scenario, body_names)
    calm = [table | {"restitution": min(CALM, table["restitution"])} for table in materials]
    options["contact"] |= {"steps": min(CALM_STEPS, options["contact"]["steps"])}
    return _kind(scenario, isa)(calm, options)


def empty_simulation(scenario: Scenario, body_names: list[str], isa: str | None = None) -> Any:
    """A core simulation of `scenario` without particles, to be filled or restored."""
    kind = _kind(scenario, isa)
    simulation = kind(core_materials(scenario), core_options(scenario, body_names))
    for section in build_inflows(scenario, body_names):
        simulation.add_inflow(_inflow_table(section))
    for outflow in scenario.outflow.values():
        simulation.add_outflow(list(outflow.min), list(outflow.max))
    for motion in wall_motions(scenario, body_names):
        simulation.move_body(motion)
    return simulation


def filled_simulation(scenario: Scenario, isa: str | None = None) -> tuple[Any, list[str]]:
    """A core simulation of `scenario` that is yet to be started, and the names of its bodies."""
    make = partial(_dry_simulation, isa=isa)
    scene = build_scene(scenario, partial(settled, make=make))
    particles, body_names = scene.particles, scene.names
    build_inflows(scenario, body_names, particles)  # for its checks against the particles
    simulation = empty_simulation(scenario, body_names, isa)
    simulation.add_particles(
        **{name: np.ascontiguousarray(v) for name, v in vars(particles).items()}
    )
    if scenario.scheme == RESOLVED:
        normal, depth = wall_geometry(scenario, particles, body_names)
        bodies = scene.bodies
        normal[bodies.shaped] = bodies.normal[bodies.shaped]
        depth[bodies.shaped] = bodies.depth[bodies.shaped]
        simulation.set_walls(normal=np.ascontiguousarray(normal), depth=np.ascontiguousarray(depth))
        add_bodies(simulation, scenario, bodies, body_names)
    return simulation, body_names


def build_simulation(scenario: Scenario, isa: str | None = None) -> tuple[Any, list[str]]:
    """A started core simulation of `scenario`, and the names of its bodies."""
    simulation, body_names = filled_simulation(scenario, isa)
    simulation.start()
    return simulation, body_names
