"""Warnings about fluids whose friction the run would not have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scenario.materials import Material
from ..scenario.model import Scenario
from ..scenario.schemes import RESOLVED
from ..solver.build import viscosity_form
from ..util.finding import Finding
from .sound_speed import usual_speed

KARMAN = 0.40
NO_PART = 0.01  # of the friction of a mass: with less it has none
FEW = 4.0  # particles over the depth of a flow, of which the lowest row is no small part


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
class NoEddies(Finding):
    """A rough wall under many particles of a thin liquid, in a run without eddies."""

    fluid: str
    across: float  # particles

    def __str__(self) -> str:
        return (
            f'{self.place} = "rough" has the friction of a turbulent stream, and with turbulence = '
            f'"none" the lowest of {self.across:.3g} particles over the depth alone feel it: where '
            f"{self.fluid} streams, what is above them gets too fast; set turbulence = "
            '"mixing_length"'
        )


@dataclass(frozen=True)
class WeakGrains(Finding):
    """A mass of mu(I) whose greatest viscosity is next to nothing beside its friction."""

    most: float  # Pa s
    own: float  # Pa s
    depth: float  # m
    speed: float  # m/s

    def __str__(self) -> str:
        return (
            f"{self.place} = {self.most:g} Pa s is less than a hundredth of the {self.own:.3g} Pa s"
            f" that friction makes in a flow {self.depth:.3g} m deep at {self.speed:.3g} m/s: it "
            "flows as a thin liquid, without friction; give it more than that"
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


@dataclass(frozen=True)
class SuctionOfAnother(Finding):
    """A liquid that walls hold back with the suction of another one."""

    own: float  # Pa
    other: str
    suction: float  # Pa

    def __str__(self) -> str:
        return (
            f"{self.place} = {self.own:g} Pa: where the liquid leaves a wall, that pulls with up "
            f"to {self.suction:g} Pa, the suction of {self.other}, which is the largest of all "
            "liquids; give all of them the same"
        )


@dataclass(frozen=True)
class TurnsTooFast(Finding):
    """A liquid that sees what turns in it as sheared."""

    liquid: str
    form: str  # how the scenario has come to it

    def __str__(self) -> str:
        return (
            f'{self.place}: {self.liquid} has viscosity = "morris"{self.form}, which resists '
            "turning as it resists shear: a free disc in a shear flow spins 0.84 times the rate of "
            'shear in place of 0.5 (0.48 with "stress"), at any dp, and what turns in a liquid at '
            'rest is braked; set viscosity = "stress"'
        )


def rheology_findings(scenario: Scenario, across: float) -> Iterator[Finding]:
    """Fluids whose friction inside or at walls would be another one.

    `across` are the particles over the depth of the deepest flow.
    """
    for name in scenario.liquids:
        material = scenario.materials[name]
        others = [other for other in scenario.liquids if other != name]
        if material.rheology == "mu_i" and others:
            yield GrainsUnderLiquid(f"material.{name}.rheology", others[0])
    yield from _suction_findings(scenario)
    yield from _turning_findings(scenario)
    yield from _weak_grains(scenario, across * scenario.dp)
    for keys, wall in scenario.walls.items():
        if wall.given("wall") == "rough":
            yield from _at_rough_wall(scenario, f"{'.'.join(keys)}.wall", wall.given("ks"), across)


def _at_rough_wall(
    scenario: Scenario, place: str, ks: float, across: float
) -> Iterator[EddiesOnly | NoEddies]:
    """Viscous liquids on it in a run with eddies, thin ones in a run without."""
    for name in scenario.liquids:
        is_viscous = _is_viscous(scenario, scenario.materials[name], ks)
        if scenario.turbulence == "none":
            if not is_viscous and across > FEW:
                yield NoEddies(place, name, across)
        elif is_viscous:
            yield EddiesOnly(place, scenario.turbulence, name)


def _weak_grains(scenario: Scenario, depth: float) -> Iterator[WeakGrains]:
    """Their friction is p mu_s over the rate of strain."""
    for name in scenario.liquids:
        fluid = scenario.materials[name]
        speed = usual_speed(scenario, fluid)
        if fluid.rheology != "mu_i" or speed <= 0:
            continue
        law = fluid.of_laws
        g = float(np.linalg.norm(scenario.gravity))
        carried = (1 - law["pore_pressure_ratio"]) * fluid.rho0 * g * depth / 2
        own = law["mu_s"] * carried * depth / speed
        if law["viscosity_max"] < NO_PART * own:
            place = f"material.{name}.viscosity_max"
            yield WeakGrains(place, law["viscosity_max"], own, depth, speed)


def _suction_findings(scenario: Scenario) -> Iterator[Finding]:
    """Walls have one suction, the largest."""
    suction = {name: scenario.materials[name].air_entry_suction for name in scenario.liquids}
    if not suction or scenario.scheme != RESOLVED:
        return
    most = max(suction, key=lambda name: suction[name])
    for name, own in suction.items():
        if own < suction[most]:
            yield SuctionOfAnother(f"material.{name}.air_entry_suction", own, most, suction[most])


def _turning_findings(scenario: Scenario) -> Iterator[Finding]:
    """Bodies that move freely, and walls that turn, in liquids with Morris' form of viscosity."""
    if scenario.scheme != RESOLVED or viscosity_form(scenario) != "morris":
        return
    turning = next((name for name in scenario.body if _may_turn(scenario, name)), None)
    if turning is None:
        return
    form = " (the default here)" if scenario.viscosity is None else ""
    for name in scenario.liquids:
        if scenario.materials[name].rheology != "newtonian" or scenario.materials[name].nu > 0:
            yield TurnsTooFast(f"body.{turning}", name, form)


def _may_turn(scenario: Scenario, name: str) -> bool:
    motion = scenario.body[name].prescribed_motion
    spin = None if motion is None else motion.angular_velocity
    return bool(spin is not None and np.any(spin)) or scenario.kinematics_of(name).is_whole


def _is_viscous(scenario: Scenario, fluid: Material, ks: float) -> bool:
    """Whether at a rough wall its own stress is larger than that of eddies, Eq. (39)."""
    if fluid.rheology != "newtonian":
        return True
    height = scenario.dp / 2
    speed = usual_speed(scenario, fluid)
    eddies = (KARMAN / math.log1p(30 * max(height, ks / 30) / ks)) ** 2 * speed
    return fluid.nu / height > eddies
