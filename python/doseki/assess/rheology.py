"""Warnings about fluids whose friction the run would not have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from ..scenario.materials import Material
from ..scenario.model import Scenario
from ..util.finding import Finding
from .sound_speed import usual_speed

KARMAN = 0.40


@dataclass(frozen=True)
class EddiesOnly(Finding):
    """A rough wall in a run with eddies, under a fluid whose own friction counts."""

    turbulence: str
    fluid: str

    def __str__(self) -> str:
        return (
            f'{self.place}: with turbulence = "{self.turbulence}" a rough wall has the friction of '
            f"turbulent water alone, on which {self.fluid} slides as if it had neither viscosity "
            'nor yield stress; set turbulence = "none", or wall = "no_slip"'
        )


@dataclass(frozen=True)
class GrainsUnderLiquid(Finding):
    """A mass of mu(I) in a run with another liquid, whose pressure its grains would not carry."""

    other: str

    def __str__(self) -> str:
        return (
            f'{self.place} = "mu_i": its grains carry all of the pressure but for a constant '
            f"share; under {self.other} they carry less, and such a heap stands where it should "
            "flow: make the grains bodies, or leave out the other liquid"
        )


def rheology_findings(scenario: Scenario) -> Iterator[Finding]:
    """Fluids whose friction inside or at walls would be another one."""
    for name in scenario.liquids:
        material = scenario.materials[name]
        others = [other for other in scenario.liquids if other != name]
        if material.rheology == "mu_i" and others:
            yield GrainsUnderLiquid(f"material.{name}.rheology", others[0])
    if scenario.turbulence == "none":
        return
    for keys, wall in scenario.walls.items():
        if wall.given("wall") != "rough":
            continue
        for name in scenario.liquids:
            if _is_viscous(scenario, scenario.materials[name], wall.given("ks")):
                yield EddiesOnly(f"{'.'.join(keys)}.wall", scenario.turbulence, name)


def _is_viscous(scenario: Scenario, fluid: Material, ks: float) -> bool:
    """Whether at a rough wall its own stress is larger than that of eddies, Eq. (39)."""
    if fluid.rheology != "newtonian":
        return True
    height = scenario.dp / 2
    speed = usual_speed(scenario, fluid)
    eddies = (KARMAN / math.log1p(30 * max(height, ks / 30) / ks)) ** 2 * speed
    return fluid.nu / height > eddies
