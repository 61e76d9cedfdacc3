"""Bodies whose material breaks: what they must be for that, and whether cracks are resolved."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ...errors import UserError
from ...scenario.materials import MOST_FLAWS, NO_FRACTURE, Material
from ...util.finding import Finding, below, no_less_than, no_more_than
from ..groups import Group
from ..kinds.body import Body

MIN_ACROSS_BREAKABLE = 8  # particles; fewer have no crack that runs between them
MIN_LENGTH = 2.0  # spacings of the length of the process zone, E G_f/f_t^2
LEAST_LENGTH = 0.2  # spacings of it; with fewer a bond snaps back as it cracks
MOST_STRENGTH = 0.1  # Young's moduli
STRAINS = (1e-8, 0.1)  # of the weakest flaw of a body: below, all is dust; above, nothing breaks


@dataclass(frozen=True)
class UnbreakableBody(Finding):
    """A body whose material breaks, but which cannot."""

    material: str

    def __str__(self) -> str:
        return (
            f"{self.place}: the material {self.material} breaks, but only bodies with "
            'kinematics = "elastic" or "breakable" do: this one will not'
        )


@dataclass(frozen=True)
class CoarseCrack(Finding):
    """A cohesive body whose points are too far apart for the zone in which a crack opens."""

    spacing: float  # m
    length: float  # m

    def __str__(self) -> str:
        enough = no_more_than(self.length / MIN_LENGTH)
        return (
            f"{self.place}: dp = {self.spacing:.2g} m, but cracks of its material open over "
            f"E G_f/f_t^2 = {self.length:.2g} m; above {enough} m they take too much energy and "
            "the body is too strong: make dp smaller"
        )


def fracture_warnings(bodies: Mapping[str, Body[Any]], groups: list[Group]) -> Iterator[Finding]:
    """What is doubtful about the bodies of materials that break.

    Raises UserError for a breakable body with too few points across, and for a key of fracture on
    a body that has no use for it.
    """
    for group in groups:
        body = bodies[group.name]
        name = body.table.material
        material = body.scenario.materials[name]
        if body.table.given("flaw_seed") is not None and material.fracture != "grady_kipp":
            raise body.error(
                f".flaw_seed: the material {name} has no random flaws; only those with fracture = "
                '"grady_kipp" do'
            )
        if group.breakable and material.fracture == NO_FRACTURE:
            raise body.error(
                f'.kinematics = "breakable": the material {name} does not break; give it a '
                'fracture, or choose "rigid" or "elastic"',
                "kinematics",
            )
        if material.fracture == NO_FRACTURE:
            continue
        if group.deforms:
            yield from _breakable(body, group, material)
        elif not group.fixed:
            yield UnbreakableBody(group.name, name)


def _breakable(body: Body[Any], group: Group, material: Material) -> Iterator[Finding]:
    width = min(shape.width for shape in group.shapes)
    across = width / body.spacing
    if across < MIN_ACROSS_BREAKABLE - 1e-6:
        enough = no_more_than(width / MIN_ACROSS_BREAKABLE)
        whole = f'a material with fracture = "{NO_FRACTURE}"'
        raise body.error(
            f": {below(across, MIN_ACROSS_BREAKABLE)} particles across a body that breaks; it "
            f"needs at least {MIN_ACROSS_BREAKABLE}: dp = {enough} would do, or "
            + ('kinematics = "rigid"' if group.breakable else whole)
        )
    if material.fracture == "cohesive":
        yield from _cohesive(body, group, material)
    elif material.fracture == "grady_kipp":
        _check_flaws(body, group, material)


def _cohesive(body: Body[Any], group: Group, material: Material) -> Iterator[Finding]:
    """Raises UserError for a strength or an energy with which nothing can be computed."""
    modulus, numbers = material.elasticity[0], material.of_laws
    strength, energy = numbers["tensile_strength"], numbers["fracture_energy"]
    most = MOST_STRENGTH * modulus
    if strength > most * (1 + 1e-9):
        raise _error_of_material(
            body,
            "tensile_strength",
            f" = {strength:.3g} Pa: must be at most {most:.3g} Pa, a tenth of Young's modulus; "
            "no material bears more, and its strains would not be small",
        )
    length = modulus * energy / strength**2
    if length < LEAST_LENGTH * body.spacing * (1 - 1e-9):
        least = no_less_than(LEAST_LENGTH * body.spacing * strength**2 / modulus)
        raise _error_of_material(
            body,
            "fracture_energy",
            f" = {energy:.3g} J/m2: cracks open over E G_f/f_t^2 = {length:.2g} m, but it must be "
            f"at least {LEAST_LENGTH:g} spacings of body.{group.name} (dp = {body.spacing:.3g} m), "
            f"whose bonds snap back otherwise: {least} J/m2 would do, or "
            f"dp = {no_more_than(length / LEAST_LENGTH)}",
        )
    if body.spacing > length / MIN_LENGTH:
        yield CoarseCrack(group.name, body.spacing, length)


def _check_flaws(body: Body[Any], group: Group, material: Material) -> None:
    """Raises UserError where the weakest flaw of a body gives way at once, or never.

    In 2-D a body is 1 m across.
    """
    k, m = (material.of_laws[key] for key in ("weibull_k", "weibull_m"))
    volumes = group.measures[0]
    for volume, least in ((volumes.max(), True), (volumes.min(), False)):
        strain, limit = float(k * volume) ** (-1 / m), STRAINS[0 if least else 1]
        if (strain >= limit) if least else (strain <= limit):
            continue
        enough = 10 ** (-m * math.log10(limit) - math.log10(volume))
        some = f"at most {no_more_than(enough)}" if least else f"at least {no_less_than(enough)}"
        remedy = f"{some} 1/m3 would do" if enough < MOST_FLAWS else "make weibull_m smaller"
        raise _error_of_material(
            body,
            "weibull_k",
            f" = {k:.3g} 1/m3: with weibull_m = {m:.3g} the weakest flaw of body.{group.name} "
            f"gives way at a strain (k V)^(-1/m) = {strain:.2g}, "
            + (f"below {limit:g}: it would be dust" if least else f"above {limit:g}: never")
            + f"; {remedy}",
        )


def _error_of_material(body: Body[Any], key: str, text: str) -> UserError:
    name = body.table.material
    keys = ("material", name, key)
    return body.scenario.where.error(keys, f"material.{name}.{key}{text}")
