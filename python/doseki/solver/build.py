"""A simulation of the compiled core, made from a scenario."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple, cast

import numpy as np

from ..compiled import available_instruction_sets, load_core
from ..scenario.gauges.loads.metered import Metered
from ..scenario.gauges.loads.overtopping import Overtopping
from ..scenario.materials import Material, equation_of_state, fracture_keys
from ..scenario.model import Scenario
from ..scenario.schemes import RESOLVED
from ..scenario.tables.body import BodyTable
from ..scenario.tables.terrain.terrain import TERRAIN, Terrain
from ..scene.build import Scene, build_scene
from ..scene.checks.bodies.grain_numbers import check_grain_numbers
from ..scene.checks.panels import check_panels
from ..scene.checks.sensors import sensor_findings
from ..scene.checks.structures import structure_findings
from ..scene.contact_faces import contact_faces
from ..scene.inflow_sections import InflowSection, build_inflows
from ..scene.lattices import ROUNDING
from ..scene.walls.normals import wall_geometry
from ..util.finding import Finding
from ..util.telling import Tell, say_nothing
from .placed import Placed, origin_of
from .protocol import CoreSimulation, Table
from .relaxing import relaxed
from .rigid_bodies import add_bodies
from .room import make_room_for_bodies
from .settling import CALM_STEPS, settled
from .wall_motions import wall_motions

__all__ = ["available_instruction_sets", "build_simulation", "load_core"]

# Margin of the first lists of a run that chooses its own.
FIRST_SKIN = 0.05
CALM = 0.2  # restitution at most while grains settle
STRENGTH = ("shear_modulus", "yield_strength", "cohesion", "friction_angle")


def core_options(scenario: Scenario, body_names: list[str]) -> dict[str, Any]:
    """The parameters of the scheme, as the core reads them."""
    names = "attraction eta alpha cflnumber cfl_force fixed_limits_dt balsara sym_grad".split()
    names += ["tension", "h_mode"]
    axes = "xyz"[: scenario.dim]
    zeros = [0.0] * scenario.dim
    low, high, origin = scenario.domain_min, scenario.domain_max, origin_of(scenario)
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
            "domain_min": zeros if low is None else list(low - origin),
            "domain_max": zeros if high is None else list(high - origin),
            "origin": list(origin),
        }
    )


def _flow_options(scenario: Scenario, body_names: list[str]) -> dict[str, Any]:
    """What only the resolved scheme has."""
    names = "dp kernel shifting acoustic_damping turbulence smagorinsky".split()
    return {name: getattr(scenario, name) for name in names} | {
        "viscosity": viscosity_form(scenario),
        "walls": [_wall_condition(scenario, _wall_of(scenario, name)) for name in body_names],
    }


def viscosity_form(scenario: Scenario) -> str:
    """That of the scenario, else what it gets: with the stress, what keeps its shape while it
    slides is braked too much by Voellmy's beds.
    """
    if scenario.viscosity is not None:
        return scenario.viscosity
    laws = {scenario.materials[name].rheology for name in scenario.liquids}
    beds = {wall.given("wall") for wall in scenario.walls.values()}
    slides = "voellmy" in beds and "herschel_bulkley" in laws
    return "morris" if slides or "mu_i" in laws else "stress"


def _contact_options(scenario: Scenario) -> dict[str, Any]:
    """How bodies touch; the speed to expect is a tenth of the sound speed of the run."""
    options = scenario.contact.model_dump() | {"steps": scenario.steps_of_contact}
    if options["speed"] is None:
        options["speed"] = 0.1 * scenario.xi * scenario.min_sound_speed
    return options


def _wall_of(scenario: Scenario, name: str) -> BodyTable | Terrain | None:
    """The table that says how fluid meets a body of this name, if one does."""
    return scenario.terrain if name == TERRAIN and scenario.terrain else scenario.body.get(name)


def _wall_condition(scenario: Scenario, body: BodyTable | Terrain | None) -> dict[str, Any]:
    wall = (body.given("wall") if body is not None else None) or "no_slip"
    moves = getattr(body, "prescribed_motion", None) is not None
    # With eddies the viscosity is theirs as well, whose stress at a rough wall is that of the law.
    sticks = wall == "no_slip" or (wall == "rough" and scenario.turbulence == "none")
    condition: dict[str, Any] = {"no_slip": sticks, "ks": 0.0, "moves": moves}
    if body is not None and wall == "rough":
        condition["ks"] = body.given("ks")
    if body is not None and wall == "voellmy":
        xi = body.given("turbulent_xi")
        condition |= {
            "voellmy": True,
            "mu": body.given("mu"),
            "turbulent_xi": math.inf if xi is None else xi,
            "effective_share": 1 - next(iter(scenario.pore_pressure_ratios), 0.0),
        }
    return condition


def core_material(material: Material, xi: float, eos: str) -> dict[str, Any]:
    """A material as the core reads it, scaled by xi but for what contacts have."""
    table = material.scaled(xi).table() | {"eos": eos}
    table["young_modulus"], table["poisson_ratio"] = material.elasticity
    return {key: value for key, value in table.items() if key not in fracture_keys()}


def core_materials(scenario: Scenario) -> list[dict[str, Any]]:
    """Materials in the order of their indices, scaled by xi; no strength where none is evolved."""
    tables = []
    eos = equation_of_state(scenario.scheme, scenario.eos)
    moving = _moving_materials(scenario)
    for name in scenario.material_names:
        table = core_material(scenario.materials[name], scenario.xi, eos)
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
        elif not body.fixed and body.material is not None:
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
        "thickness": section.thickness.tolist(),
        "row_height": section.row_height.tolist(),
        "material": int(section.material),
        "body": int(section.body),
    }


def _new_simulation(
    scenario: Scenario,
    body_names: list[str],
    isa: str | None,
    materials: Sequence[Table],
    options: Table,
) -> CoreSimulation:
    """One without particles, on its terrain."""
    kind = scenario.scheme, scenario.dim, scenario.precision
    core = cast(CoreSimulation, load_core(isa).Simulation(*kind, materials, options))
    origin = origin_of(scenario)
    simulation = cast(CoreSimulation, Placed(core, origin)) if origin.any() else core
    if scenario.bed is not None:
        simulation.set_terrain(scenario.bed.table, _terrain_wall(scenario, body_names))
        make_room_for_bodies(simulation, scenario)
    return simulation


def _dry_simulation(
    scenario: Scenario, body_names: list[str], isa: str | None = None
) -> CoreSimulation:
    """For grains that settle: where they come to rest is wanted, not how they bounce before."""
    materials, options = core_materials(scenario), core_options(scenario, body_names)
    calm = [table | {"restitution": min(CALM, table["restitution"])} for table in materials]
    options["contact"] |= {"steps": min(CALM_STEPS, options["contact"]["steps"])}
    return _new_simulation(scenario, body_names, isa, calm, options)


def empty_simulation(
    scenario: Scenario, body_names: list[str], isa: str | None = None
) -> CoreSimulation:
    """A core simulation of `scenario` without particles, to be filled or restored."""
    materials, options = core_materials(scenario), core_options(scenario, body_names)
    simulation = _new_simulation(scenario, body_names, isa, materials, options)
    for section in build_inflows(scenario, body_names):
        simulation.add_inflow(_inflow_table(section))
    for outflow in scenario.outflow.values():
        simulation.add_outflow(list(outflow.min), list(outflow.max))
    for motion in wall_motions(scenario, body_names):
        simulation.move_body(motion)
    setting = scenario.setting(body_names)
    for name in scenario.metered:
        simulation.add_load_meter(cast(Metered, scenario.gauge[name]).meter(setting))
    for name in scenario.crossed:
        plane = cast(Overtopping, scenario.gauge[name])
        simulation.add_plane(list(plane.position), list(plane.normal))
    if scenario.earlier is not None:
        simulation.begin_at(scenario.begins_at)
    return simulation


def _terrain_wall(scenario: Scenario, body_names: list[str]) -> dict[str, Any]:
    """What the wall particles of the terrain are like."""
    assert scenario.terrain is not None
    name = scenario.terrain.material
    return {
        "dp": scenario.dp,
        "layers": math.ceil(scenario.support / scenario.dp - ROUNDING),
        "density": scenario.materials[name].rho0,
        "smoothing_length": scenario.eta * scenario.dp,
        "material": scenario.material_names.index(name),
        "body": body_names.index(TERRAIN),
        "faces": scenario.uplift and not scenario.is_dry,
    }


class Filled(NamedTuple):
    """A simulation that is yet to be started, the names of its bodies, and warnings about it."""

    simulation: CoreSimulation
    body_names: list[str]
    warnings: list[Finding]


def filled_simulation(
    scenario: Scenario, isa: str | None = None, tell: Tell = say_nothing
) -> Filled:
    """A core simulation of `scenario` with its particles and bodies.

    `tell` hears how far grains have settled and water relaxed, which may take long.
    """
    make = partial(_dry_simulation, isa=isa)
    scene = build_scene(scenario, partial(settled, make=make, tell=tell))
    body_names = scene.names
    check_grain_numbers(scenario, scene.bodies)
    build_inflows(scenario, body_names, scene.particles)  # for its checks against the particles
    if scenario.relax is not None:
        _check_relaxing(scenario, scene)
        still = core_materials(scenario), core_options(scenario, body_names)
        alone = _new_simulation(scenario, body_names, isa, *still)
        _fill(alone, scenario, scene)
        scene = replace(scene, particles=relaxed(scene.particles, alone, scenario.relax, tell))
    simulation = empty_simulation(scenario, body_names, isa)
    of_walls = _fill(simulation, scenario, scene)
    return Filled(simulation, body_names, [*scene.warnings, *of_walls])


def _check_relaxing(scenario: Scenario, scene: Scene) -> None:
    """Refuse to relax among what would move, or what has moved before."""
    if scenario.earlier is not None:
        why = "the run begins with a snapshot, whose water is where it was"
    elif any(not group.fixed for group in scene.bodies.groups) or scene.bodies.elastic:
        why = "bodies that move would not wait: relax without them, then [start] from that run"
    else:
        return
    raise scenario.where.error(("relax",), f"relax = {scenario.relax:g}: {why}")


def _fill(simulation: CoreSimulation, scenario: Scenario, scene: Scene) -> list[Finding]:
    """Particles and bodies into an empty simulation; warnings about sensors and structures."""
    particles, body_names, bodies = scene.particles, scene.names, scene.bodies
    simulation.add_particles(
        **{name: np.ascontiguousarray(v) for name, v in vars(particles).items()}
    )
    if scene.stress is not None:
        simulation.set_stresses(scene.stress)
    if scenario.scheme != RESOLVED:
        return []
    normal, depth, edges = wall_geometry(scenario, particles, body_names, bodies)
    surface = {"normal": normal, "depth": depth, "curvature": bodies.curvature}
    simulation.set_walls(**{name: np.ascontiguousarray(v) for name, v in surface.items()})
    simulation.set_edges(
        normals=edges.normals.reshape(len(depth), scenario.dim**2), depths=edges.depths
    )
    if scenario.uplift and (len(bodies) or bodies.elastic):
        faces = contact_faces(scenario, particles, bodies, depth, normal)
        simulation.set_faces(face=faces.face, area=faces.area)
    add_bodies(simulation, scenario, bodies, body_names)
    check_panels(scenario, particles, body_names, {"normal": normal, "depth": depth})
    walls = scenario, particles, body_names, normal, depth
    return [*sensor_findings(*walls), *structure_findings(*walls)]


def build_simulation(
    scenario: Scenario, isa: str | None = None
) -> tuple[CoreSimulation, list[str]]:
    """A started core simulation of `scenario`, and the names of its bodies."""
    simulation, body_names, _ = filled_simulation(scenario, isa)
    simulation.start()
    return simulation, body_names
