"""What fixed bodies without bodies of their own are for those that touch them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..record.particles import FIXED, ParticleSet
from ..scenario import kinematics
from ..scenario.model import Scenario
from .groups import UPRIGHT, Group
from .kinds.body import Body
from .shapes import Ball


def contact_groups(
    scenario: Scenario,
    bodies: Mapping[str, Body[Any]],
    names: list[str],
    particles: ParticleSet,
) -> Iterator[Group]:
    """A whole box is a convex body, a disc or sphere a ball.

    Of points, of what a file holds and of what `where` or `count` leaves of a shape, each particle
    is a ball of its spacing.
    """
    for number, name in enumerate(names):
        body = bodies.get(name)
        if body is not None and body.is_of_bodies:
            continue
        whole = body.contact_shape() if body is not None else None
        if whole is not None:
            yield whole
            continue
        mine = (particles.body == number) & (particles.motion == FIXED)
        if mine.any():
            yield from _balls(scenario, name, particles, mine)


def _balls(
    scenario: Scenario, name: str, particles: ParticleSet, mine: np.ndarray
) -> Iterator[Group]:
    """One ball for each particle, in a group for each material."""
    rho0 = np.array([scenario.materials[m].rho0 for m in scenario.material_names])
    kinds = particles.material[mine]
    spacing = (particles.mass[mine] / rho0[kinds]) ** (1 / scenario.dim)
    sizes, which = np.unique(np.round(spacing, 12), return_inverse=True)
    for material in np.unique(kinds):
        of_it = kinds == material
        yield Group(
            name,
            [Ball(0.5 * size, scenario.dim) for size in sizes],
            which[of_it].astype(np.int32),
            particles.position[mine][of_it],
            np.tile(UPRIGHT, (int(of_it.sum()), 1)),
            scenario.material_names[material],
            kinematics.FIXED,
        )
