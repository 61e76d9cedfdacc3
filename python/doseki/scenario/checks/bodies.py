"""Checks of tables [body.NAME] against the scheme, the dimension and their material."""

from __future__ import annotations

import numpy as np

from ..kinematics import DEFORM, SINGLE
from ..model import Scenario
from ..schemes import RESOLVED
from ..tables.body import BodyTable


def check_bodies(scenario: Scenario) -> None:
    """Raise UserError for bodies that the scheme or the dimension does not have."""
    for name, body in scenario.body.items():
        if name in scenario.particle_tables:
            _check_file(scenario, name, body)
            continue
        _check_dimension(scenario, name, body)
        _check_solid(scenario, name, body)
        _check_keys(scenario, name, body)
        _check_shaped(scenario, name, body)
        if scenario.kinematics_of(name).is_whole:
            _check_whole(scenario, name, body)
    for name in scenario.material_names:
        _check_sound(scenario, name)


def _check_file(scenario: Scenario, name: str, body: BodyTable) -> None:
    table = scenario.particle_tables[name]
    for key in ("fixed", "material"):
        if key in table.columns and key in body.model_fields_set:
            raise scenario.where.error(
                ("body", name, key),
                f"body.{name}.{key}: the file has a column of this name; remove one of them",
            )
    if scenario.scheme != RESOLVED:
        return
    fixed = np.full(len(table), body.fixed) if table.fixed is None else table.fixed
    law = np.array([scenario.materials[m].law for m in table.material_names])[table.material]
    if (~fixed & (law == "solid")).any():
        raise scenario.where.error(
            ("body", name, "file"),
            f"body.{name}: solids of a file do not move in the resolved scheme: make them fixed, "
            'or give bodies a shape (points with kinematics = "single")',
        )


def _check_dimension(scenario: Scenario, name: str, body: BodyTable) -> None:
    if body.only_dim not in (None, scenario.dim):
        raise scenario.where.error(
            ("body", name, "shape"),
            f'body.{name}: shape = "{body.shape}" belongs to a {body.only_dim}-D run, not to dim = '
            f"{scenario.dim}",
        )
    spin = body.given("spin")
    if spin is not None and np.ndim(spin) != (0 if scenario.dim == 2 else 1):
        needed = "a number" if scenario.dim == 2 else "a vector of 3 entries"
        shown = np.asarray(spin).tolist()
        raise scenario.where.error(
            ("body", name, "spin"),
            f"body.{name}.spin = {shown}: a {scenario.dim}-D run needs {needed}, rad/s",
        )


def _check_solid(scenario: Scenario, name: str, body: BodyTable) -> None:
    """Some shapes are made of bodies, which only solids of the resolved scheme are."""
    solid = body.material is not None and scenario.materials[body.material].law == "solid"
    if not body.is_solid or (solid and scenario.scheme == RESOLVED):
        return
    if scenario.scheme == RESOLVED:
        ball = "disc" if scenario.dim == 2 else "sphere"
        why = (
            f'is for solids, and {body.material} is a fluid: fluids have the shape "box" (rotate '
            f'turns it, where = "= ..." keeps what is above zero of it), "{ball}" with centre and '
            'radius, "points", "file", or "release" on a terrain; else choose a solid material'
        )
    else:
        not_solid = "" if solid else f" and a solid material, not {body.material}"
        why = f'is a solid of the resolved scheme: set scheme = "resolved"{not_solid}'
    raise scenario.where.error(("body", name, "shape"), f"body.{name}: {body.described} {why}")


def _check_keys(scenario: Scenario, name: str, body: BodyTable) -> None:
    """No key may be given that means nothing for the way in which the body moves."""
    kinematics = scenario.kinematics_of(name)
    for key in type(body).model_fields:
        why = kinematics.why_not(key)
        if why is not None and not body.has_default(key):
            raise scenario.where.error(("body", name, key), f"body.{name}.{key}: {why}")


def _check_shaped(scenario: Scenario, name: str, body: BodyTable) -> None:
    """The particles of a shape that is always a body are at rest, with the normals of the shape."""
    for key in ("pressure", "normal") if body.is_solid else ():
        if not body.has_default(key):
            raise scenario.where.error(
                ("body", name, key),
                f"body.{name}.{key}: {body.described} has none of its own; remove it",
            )


def _check_whole(scenario: Scenario, name: str, body: BodyTable) -> None:
    """A body that moves as a whole: as what, and without keys of particles."""
    keys = ("body", name, "kinematics")
    if body.given("kinematics") == "single" and not body.can_be_single:
        raise scenario.where.error(
            keys,
            f'body.{name}.kinematics = "single" is one particle per disc, sphere or point; '
            f'shape = "{body.shape}" can only be rigid',
        )
    if body.must_be_single and body.given("kinematics") != "single":
        raise scenario.where.error(
            keys,
            f"body.{name}: points of a solid move as grains of one particle: set kinematics = "
            '"single", or fixed = true, or use the scheme ueta2022',
        )
    if scenario.kinematics_of(name) is SINGLE and body.given("dp") is not None:
        raise scenario.where.error(
            ("body", name, "dp"),
            f"body.{name}.dp: a grain of one particle has no spacing; remove it",
        )
    for key in body.of_particles:
        if key in body.model_fields_set:
            raise scenario.where.error(
                ("body", name, key),
                f"body.{name}.{key}: a body that moves as a whole has none; remove it, or use the "
                "scheme ueta2022",
            )


def _check_sound(scenario: Scenario, name: str) -> None:
    """A solid without a sound speed can be rigid or fixed, where nothing else follows from it."""
    material = scenario.materials[name]
    if material.has_sound:
        return
    stiff = material.young_modulus is not None
    ways = [scenario.kinematics_of(body) for body, t in scenario.body.items() if t.material == name]
    why = None
    if scenario.scheme != RESOLVED:
        why = f"the scheme {scenario.scheme} computes with it"
    elif any(way.name in DEFORM for way in ways) and not stiff:
        why = "the stiffness of elastic bodies follows from it, or from young_modulus"
    elif scenario.contact.stiffness == "material" and not stiff:
        why = "the stiffness of contacts follows from it, or from young_modulus"
    if why is not None:
        raise scenario.where.error(
            ("material", name), f"material.{name}.speedsound is missing: {why}"
        )
