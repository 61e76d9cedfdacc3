"""Fluid that comes to rest among fixed bodies before a run starts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..compiled import load_core
from ..errors import PhysicsError
from ..record.particles import FREE, ParticleSet
from ..util.telling import Tell, say_nothing
from .protocol import CoreSimulation

STEPS = 8  # between two looks at the kinetic energy: a small part of any oscillation


def relaxed(
    particles: ParticleSet, simulation: CoreSimulation, seconds: float, tell: Tell = say_nothing
) -> ParticleSet:
    """The particles where the free ones come to, and their density, in so many seconds.

    `simulation` holds the particles and is yet to be started.  All velocities are removed at each
    peak of the kinetic energy (kinetic damping: Cundall, 1976), where a column that sinks into the
    gaps of its start passes its equilibrium.  Raises PhysicsError where that fails.
    """
    simulation.start()
    energy = 0.0
    try:
        while simulation.time < seconds:
            simulation.advance(limit=seconds, pause=seconds, max_steps=STEPS)
            tell(f"water relaxes: {simulation.time:.3g} s of {seconds:.3g} s")
            before, energy = energy, simulation.totals()["kinetic_energy"]
            if energy < before:
                now = simulation.checkpoint()
                simulation.restore(now | {"velocity": np.zeros_like(now["velocity"])})
                energy = 0.0
    except load_core().PhysicsFailure as failure:
        raise PhysicsError(f"relax: {failure}") from None
    state, free = simulation.state(), particles.motion == FREE
    # A terrain has added wall particles of its own; what flowed away cannot be put back.
    place = np.searchsorted(state["id"], particles.id)
    if not np.array_equal(np.take(state["id"], place, mode="clip"), particles.id):
        raise PhysicsError("relax: particles left the run before they came to rest")
    return replace(
        particles,
        position=np.where(free[:, None], state["position"][place], particles.position),
        density=np.where(free, state["density"][place], particles.density),
    )
