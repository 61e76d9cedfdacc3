"""Checks of a scenario's tables against one another."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from .errors import UserError
from .gauge_tables import check_gauges
from .grain_checks import check_grains
from .motions import check_motions
from .nearest import suggestion
from .quantities import check_quantity
from .schema import SECTIONS
from .schemes import RESOLVED

if TYPE_CHECKING:
    from .scenario import Scenario

MAX_OUTPUTS = 1e6


def check_scenario(scenario: Scenario) -> None:
    """Raise UserError where tables that are right by themselves do not fit together."""
    _check_names(scenario)
    _check_references(scenario)
    _check_colours(scenario)
    _check_outputs(scenario)
    _check_periodic(scenario)
    if scenario.scheme == RESOLVED:
        _check_resolved(scenario)
    else:
        _check_ueta2022(scenario)
    check_grains(scenario)
    check_motions(scenario)
    check_gauges(scenario)


def _check_names(scenario: Scenario) -> None:
    """Names of tables become names of files and columns, so they must be fit for that."""
    for section in SECTIONS:
        for name in getattr(scenario, section):
            if not re.fullmatch(r"\w[\w .+-]{0,59}", name):
                raise scenario.where.error(
                    (section, name),
                    f'"{name}" cannot be a name in [{section}]; names begin with a letter or digit'
                    " and have at most 60 letters, digits, spaces, _, -, + or dots",
                )


def _check_references(scenario: Scenario) -> None:
    """Every material and window that is named must exist, and there must be something to run."""
    if not scenario.body and not scenario.inflow:
        raise scenario.where.error((), "a scenario needs at least one [body.NAME] or [inflow.NAME]")
    for section in ("body", "inflow", "figure"):
        for name, part in getattr(scenario, section).items():
            _check_known(scenario, (section, name, "material"), part.material, scenario.materials)
    for name, gauge in scenario.gauge.items():
        material = getattr(gauge, "material", None)
        _check_known(scenario, ("gauge", name, "material"), material, scenario.materials)
    for name, body in scenario.body.items():
        wetted_by = getattr(body, "wetted_by", None)
        _check_known(scenario, ("body", name, "wetted_by"), wetted_by, scenario.materials)
    for name, figure in scenario.figure.items():
        _check_known(scenario, ("figure", name, "window"), figure.window, scenario.window)
        _check_known(scenario, ("figure", name, "gauge"), figure.gauge, scenario.gauge)
    for name, particles in scenario.particle_tables.items():
        for material in particles.material_names:
            _check_known(scenario, ("body", name, "file"), material, scenario.materials)


def _check_known(
    scenario: Scenario, keys: tuple[str, ...], name: str | None, known: dict[str, Any]
) -> None:
    if name is not None and name not in known:
        path = ".".join(keys)
        if keys[-1] == "file":
            message = f'{path}: the file names the unknown material "{name}"'
        else:
            message = f'{path} = "{name}" is not a known {keys[-1]}'
        raise scenario.where.error(keys, message + suggestion(name, known))


def _check_colours(scenario: Scenario) -> None:
    """A figure must not fail at the end of a long run."""
    for name, figure in scenario.figure.items():
        for colour in figure.colour:
            try:
                check_quantity(colour, scenario.dim)
            except UserError as error:
                keys = ("figure", name, "colour")
                raise scenario.where.error(keys, f"figure.{name}.colour: {error}") from None


def _check_outputs(scenario: Scenario) -> None:
    """An interval that is far too short would fill the disk."""
    for key, interval in (("time_out", scenario.time_out), ("time_history", scenario.time_history)):
        if scenario.time_max / interval > MAX_OUTPUTS:
            raise scenario.where.error(
                (key,),
                f"{key} = {interval:g} s is too short for time_max = {scenario.time_max:g} s; "
                f"at most {MAX_OUTPUTS:g} outputs are made",
            )


def _check_periodic(scenario: Scenario) -> None:
    """Periodic axes must exist and have a domain."""
    for axis in scenario.periodic:
        if axis not in "xyz"[: scenario.dim]:
            raise scenario.where.error(("periodic",), f'periodic: a 2-D run has no axis "{axis}"')
        if scenario.domain_min is None or scenario.domain_max is None:
            raise scenario.where.error(("periodic",), "periodic needs domain_min and domain_max")


def _check_ueta2022(scenario: Scenario) -> None:
    """What the scheme of the paper does not have."""
    if scenario.kernel != "wendland_c6":
        message = f'kernel = "{scenario.kernel}": the scheme ueta2022 has wendland_c6 alone'
        raise scenario.where.error(("kernel",), message)
    for name in (part.material for part in [*scenario.body.values(), *scenario.inflow.values()]):
        rheology = scenario.materials[name].rheology if name else "newtonian"
        if rheology != "newtonian":
            raise scenario.where.error(
                ("material", name, "rheology"),
                f'material.{name}.rheology = "{rheology}": the scheme ueta2022 has newtonian '
                'fluids alone; use scheme = "resolved"',
            )


def _check_resolved(scenario: Scenario) -> None:
    """What the resolved scheme needs or cannot do."""
    if scenario.precision != "double":
        raise scenario.where.error(
            ("precision",), 'precision: the resolved scheme runs in "double"'
        )
    if scenario.xi is None and scenario.xi_height is None and scenario.speed_max is None:
        raise scenario.where.error(
            ("scheme",),
            "the resolved scheme needs the highest speed to expect: give speed_max (m/s), "
            "xi_height (m) or xi",
        )
    for name, body in scenario.body.items():
        keys = ("body", name)
        normal = getattr(body, "normal", None)
        if normal is not None and not normal.any():
            raise scenario.where.error((*keys, "normal"), f"body.{name}.normal must not be zero")
        if getattr(body, "wall", None) == "rough" and body.ks is None:
            raise scenario.where.error((*keys, "ks"), f"body.{name}: a rough wall needs ks (m)")
    for name, inflow in scenario.inflow.items():
        if scenario.materials[inflow.material].law != "fluid":
            raise scenario.where.error(
                ("inflow", name, "material"),
                f"inflow.{name}: the resolved scheme moves fluids only, not {inflow.material}",
            )
