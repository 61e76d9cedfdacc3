"""Checks of a scenario's tables against one another."""

from __future__ import annotations

from ..materials import EQUATIONS_OF_STATE, RHEOLOGIES, laws_of
from ..model import Scenario
from ..schemes import RESOLVED, UETA2022
from ..tables.wall import WallKeys
from .bodies import check_bodies
from .effort import check_effort
from .gauges import check_figures, check_gauges
from .maps import check_maps
from .meaning import check_meaning
from .motions import check_motions
from .start import check_start
from .terrain import check_terrain

MAX_OUTPUTS = 1e6


def check_scenario(scenario: Scenario) -> None:
    """Raise UserError where tables that are right by themselves do not fit together."""
    check_effort(scenario)
    _check_outputs(scenario)
    _check_periodic(scenario)
    if scenario.scheme == RESOLVED:
        _check_resolved(scenario)
    else:
        _check_ueta2022(scenario)
    check_meaning(scenario)
    check_bodies(scenario)
    check_motions(scenario)
    check_gauges(scenario)
    check_figures(scenario)
    check_maps(scenario)
    check_start(scenario)
    check_terrain(scenario)


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
    """Periodic axes must exist and have a domain, which has two corners."""
    corners = {"domain_min": scenario.domain_min, "domain_max": scenario.domain_max}
    given = [key for key, corner in corners.items() if corner is not None]
    if len(given) == 1:
        other = next(key for key in corners if key not in given)
        raise scenario.where.error((given[0],), f"{given[0]} goes with {other}, the other corner")
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
    if scenario.eos != type(scenario).model_fields["eos"].default:
        own = " or ".join(laws_of(EQUATIONS_OF_STATE, UETA2022))
        raise scenario.where.error(
            ("eos",),
            f'eos = "{scenario.eos}": the scheme ueta2022 has {own} alone; use scheme = "resolved"',
        )
    for name in scenario.material_names:
        rheology = scenario.materials[name].rheology
        if scenario.scheme not in RHEOLOGIES[rheology].schemes:
            raise scenario.where.error(
                ("material", name, "rheology"),
                f'material.{name}.rheology = "{rheology}": the scheme ueta2022 has newtonian '
                'fluids alone; use scheme = "resolved"',
            )


def _check_effective_stress(scenario: Scenario) -> None:
    """A Voellmy bed takes one share of the normal stress for that of the pore water."""
    voellmy = [keys for keys, wall in scenario.walls.items() if wall.given("wall") == "voellmy"]
    if voellmy and len(ratios := scenario.pore_pressure_ratios) > 1:
        (ratio, one), (another, other) = list(ratios.items())[:2]
        raise scenario.where.error(
            (*voellmy[0], "wall"),
            f'{".".join(voellmy[0])}.wall = "voellmy" needs one pore_pressure_ratio of all '
            f"fluids, but {one} has {ratio:g} and {other} has {another:g}",
        )


def _check_resolved(scenario: Scenario) -> None:
    """What the resolved scheme needs or cannot do."""
    if not scenario.model_fields_set & {"xi", "xi_height", "speed_max"}:
        raise scenario.where.error(
            ("scheme",),
            "the resolved scheme needs the highest speed to expect: give speed_max (m/s), "
            "xi_height (m) or xi",
        )
    if scenario.contact.law == "hertz" and scenario.dim == 2:
        raise scenario.where.error(
            ("contact", "law"), 'contact.law = "hertz" is of spheres: discs touch along a line'
        )
    default = type(scenario).model_fields["smagorinsky"].default
    if "turbulence" not in scenario.model_fields_set and scenario.smagorinsky != default:
        raise scenario.where.error(
            ("smagorinsky",), 'smagorinsky goes with turbulence = "smagorinsky"'
        )
    for keys, wall in scenario.walls.items():
        key, objection = WallKeys.needed_by_wall.get(wall.given("wall") or "", ("", ""))
        if key and wall.given(key) is None:
            raise scenario.where.error((*keys, "wall"), f"{'.'.join(keys)}: {objection}")
    for name, body in scenario.body.items():
        keys = ("body", name)
        normal = body.given("normal")
        if normal is not None and not normal.any():
            raise scenario.where.error((*keys, "normal"), f"body.{name}.normal must not be zero")
    _check_effective_stress(scenario)
    for name, inflow in scenario.inflow.items():
        if scenario.materials[inflow.material].law != "fluid":
            raise scenario.where.error(
                ("inflow", name, "material"),
                f"inflow.{name}: the resolved scheme moves fluids only, not {inflow.material}",
            )
