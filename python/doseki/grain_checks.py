"""Checks of tables [body.NAME] that are bodies, and warnings about their resolution."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from .elastic_bodies import ELASTIC_KEYS
from .elastic_bodies import LEAST_ACROSS as LEAST_ELASTIC
from .schema import Disc, Grains, LatticeBody, Mesh, ParticleFile, Points, Polygon
from .schemes import RESOLVED

if TYPE_CHECKING:
    from .grains import Group
    from .scenario import Scenario

LEAST_ACROSS = 5  # particles; below, a body is not resolved
# What means something only for particles that move by themselves.
OF_PARTICLES = ("pressure", "jitter", "where", "mass_per_particle", "wetted_by", "count")


def check_grains(scenario: Scenario) -> None:
    """Raise UserError for bodies that the scheme or the dimension does not have."""
    for name, body in scenario.body.items():
        if isinstance(body, ParticleFile):
            _check_file(scenario, name, body)
            continue
        _check_dimension(scenario, name, body)
        solid = scenario.materials[body.material].law == "solid"
        if isinstance(body, Grains | Polygon | Mesh) and not (
            solid and scenario.scheme == RESOLVED
        ):
            what = f'shape = "{body.shape}"' + (" with d" if isinstance(body, Grains) else "")
            raise scenario.where.error(
                ("body", name, "shape"),
                f"body.{name}: {what} is a solid of the resolved scheme: set scheme = "
                f'"resolved" and a solid material, not {body.material}',
            )
        if solid and not body.fixed and scenario.scheme == RESOLVED:
            _check_moving(scenario, name, body)
        else:
            _check_not_moving(scenario, name, body)


def _check_file(scenario: Scenario, name: str, body: ParticleFile) -> None:
    if scenario.scheme != RESOLVED:
        return
    table = scenario.particle_tables[name]
    fixed = np.full(len(table), body.fixed) if table.fixed is None else table.fixed
    law = np.array([scenario.materials[m].law for m in table.material_names])[table.material]
    if (~fixed & (law == "solid")).any():
        raise scenario.where.error(
            ("body", name, "file"),
            f"body.{name}: solids of a file do not move in the resolved scheme: make them fixed, "
            'or give bodies a shape (points with kinematics = "single")',
        )


def _check_dimension(scenario: Scenario, name: str, body: Any) -> None:
    wanted = {Polygon: 2, Mesh: 3}.get(type(body), scenario.dim)
    if wanted != scenario.dim:
        raise scenario.where.error(
            ("body", name, "shape"),
            f'body.{name}: shape = "{body.shape}" belongs to a {wanted}-D run, not to dim = '
            f"{scenario.dim}",
        )
    if body.spin is not None and np.ndim(body.spin) != (0 if scenario.dim == 2 else 1):
        needed = "a number" if scenario.dim == 2 else "a vector of 3 entries"
        shown = np.asarray(body.spin).tolist()
        raise scenario.where.error(
            ("body", name, "spin"),
            f"body.{name}.spin = {shown}: a {scenario.dim}-D run needs {needed}, rad/s",
        )


def _check_moving(scenario: Scenario, name: str, body: Any) -> None:
    keys = ("body", name, "kinematics")
    if body.kinematics != "elastic":
        _check_no_keys(scenario, name, body, ELASTIC_KEYS, 'only kinematics = "elastic" has it')
    if body.kinematics == "single" and not isinstance(body, Disc | Grains | Points):
        raise scenario.where.error(
            keys,
            f'body.{name}.kinematics = "single" is one particle per disc, sphere or point; '
            f'shape = "{body.shape}" can only be rigid',
        )
    if isinstance(body, Points) and body.kinematics != "single":
        raise scenario.where.error(
            keys,
            f"body.{name}: points of a solid move as grains of one particle: set kinematics = "
            '"single", or fixed = true, or use the scheme ueta2022',
        )
    useless = OF_PARTICLES if isinstance(body, LatticeBody) else OF_PARTICLES[:1]
    for key in useless:
        if key in body.model_fields_set:
            raise scenario.where.error(
                ("body", name, key),
                f"body.{name}.{key}: a body that moves as a whole has none; remove it, or use the "
                "scheme ueta2022",
            )


def _check_not_moving(scenario: Scenario, name: str, body: Any) -> None:
    why = "only solids of the resolved scheme that are not fixed have it"
    _check_no_keys(scenario, name, body, ("kinematics", "spin", "settle", *ELASTIC_KEYS), why)


def _check_no_keys(
    scenario: Scenario, name: str, body: Any, keys: tuple[str, ...], why: str
) -> None:
    for key in keys:
        if getattr(body, key, None) not in (None, False):
            raise scenario.where.error(("body", name, key), f"body.{name}.{key}: {why}")


def resolution_warnings(scenario: Scenario, groups: list[Group]) -> Iterator[str]:
    """One sentence for each body that has too few particles across."""
    for group in groups:
        if group.fixed or group.single:
            continue
        spacing = getattr(scenario.body[group.name], "dp", None) or scenario.dp
        across = min(shape.width for shape in group.shapes) / spacing
        if group.elastic:
            yield from _elastic_warnings(scenario, group.name, across)
        elif across < LEAST_ACROSS - 1e-6:
            yield (
                f"{group.name}: {across:.2g} particles across its bodies; below {LEAST_ACROSS} the "
                f"flow around them is not resolved: dp = {across * spacing / LEAST_ACROSS:.2g} "
                'would do, or kinematics = "single"'
            )


def _elastic_warnings(scenario: Scenario, name: str, across: float) -> Iterator[str]:
    """As resolution_warnings; raises UserError for a body that its particles do not span."""
    if across < LEAST_ELASTIC - 1e-6:
        raise scenario.where.error(
            ("body", name),
            f"body.{name}: {across:.2g} particles across an elastic body; it needs at least "
            f"{LEAST_ELASTIC}: make dp smaller",
        )
    if across < LEAST_ACROSS - 1e-6:
        yield (
            f"{name}: {across:.2g} particles across an elastic body; below {LEAST_ACROSS} it bends "
            "by a tenth too easily or more: make dp smaller"
        )
