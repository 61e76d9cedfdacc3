"""Checks of the initial particles that no table of a scenario can show by itself."""

from __future__ import annotations

import numpy as np

from ...record.particles import ParticleSet
from ...record.units import unit_in
from ...scenario.model import Scenario
from ...scenario.schemes import SUPPORT
from ...scenario.values.types import LARGEST, SMALLEST
from ..lattices import ROUNDING


def check_particles(scenario: Scenario, particles: ParticleSet, names: list[str]) -> None:
    """Raise UserError for absurd masses, and for particles that do not fit a periodic domain."""
    _check_spacing(scenario, particles, names)
    for axis in scenario.periodic:
        _check_period(scenario, particles, "xyz".index(axis))
        _check_inside(scenario, particles, names, "xyz".index(axis))


def _check_spacing(scenario: Scenario, particles: ParticleSet, names: list[str]) -> None:
    """A mass given by hand can be absurd; the lengths that follow from it must not be."""
    spacing = (particles.mass / particles.density) ** (1 / scenario.dim)
    wrong = ~((spacing >= SMALLEST) & (spacing <= LARGEST))
    if wrong.any():
        first = int(np.argmax(wrong))
        body = names[particles.body[first]]
        raise scenario.where.error(
            ("body", body),
            f"body.{body}: a mass of {particles.mass[first]:g} {unit_in('kg', scenario.dim)} at "
            f"{particles.density[first]:g} kg/m3 is {spacing[first]:g} m across; allowed: "
            f"{SMALLEST:g} to {LARGEST:g} m",
        )


def _check_period(scenario: Scenario, particles: ParticleSet, axis: int) -> None:
    """A particle must not meet its own image, nor a neighbour twice."""
    low, high = scenario.ends_of(axis)
    length = high - low
    support = max(SUPPORT * particles.smoothing_length.max(initial=0.0), scenario.support)
    if length < 2 * support * (1 - ROUNDING):
        raise scenario.where.error(
            ("domain_max",),
            f"domain_max: the domain is {length:g} m long along {'xyz'[axis]}; a periodic axis "
            f"needs at least twice the support of a particle, {2 * support:g} m",
        )


def _check_inside(scenario: Scenario, particles: ParticleSet, names: list[str], axis: int) -> None:
    """Along a periodic axis every particle must start inside the domain."""
    low, high = scenario.ends_of(axis)
    x = particles.position[:, axis]
    outside = (x < low) | (x >= high)
    if outside.any():
        first = int(np.argmax(outside))
        body = names[particles.body[first]]
        raise scenario.where.error(
            ("body", body),
            f"body.{body}: a particle at {'xyz'[axis]} = {x[first]:g} m lies outside the periodic "
            f"domain, {low:g} to {high:g} m",
        )
