"""Bodies whose material breaks: what they must be for that, and whether cracks are resolved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ...scenario.materials import NO_FRACTURE, Material
from ...util.finding import Finding, no_more_than
from ..groups import Group
from ..kinds.body import Body

MIN_ACROSS_BREAKABLE = 8  # particles; fewer have no crack that runs between them
MIN_LENGTH = 2.0  # spacings of the length of the process zone, E G_f/f_t^2


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
            f": {across:.2g} particles across a body that breaks; it needs at least "
            f"{MIN_ACROSS_BREAKABLE}: dp = {enough} would do, or "
            + ('kinematics = "rigid"' if group.breakable else whole)
        )
    if material.fracture == "cohesive":
        numbers = material.of_laws
        modulus = material.elasticity[0]
        length = modulus * numbers["fracture_energy"] / numbers["tensile_strength"] ** 2
        if body.spacing > length / MIN_LENGTH:
            yield CoarseCrack(group.name, body.spacing, length)
