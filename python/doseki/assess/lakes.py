"""Boxes of fluid over a terrain: what lies above the ground, and what of that particles make."""

from __future__ import annotations

import numpy as np

from ..record.particles import FREE
from ..scenario.model import Scenario
from ..scenario.tables.bodies import Box
from ..scene.ground import LEAST_HEIGHT, ground_of
from ..scene.kinds.registry import body_of

PARTS = 4  # along each side of a cell, by which its share above the ground is counted
NEAR = 0.9  # spacings from the ground beyond which a cell is on one side of it


def filled_volumes(scenario: Scenario) -> dict[str, tuple[float, float]]:
    """Of each box of particles on a terrain: volume above the ground, and in particles, m3.

    They are the same where the ground does not cut it. What other bodies take of it is not left
    out.
    """
    found: dict[str, tuple[float, float]] = {}
    if scenario.bed is None:
        return found
    ground = ground_of(scenario.bed)
    for name, table in scenario.body.items():
        if not isinstance(table, Box) or table.fixed or name in scenario.carried:
            continue
        body = body_of(scenario, name)
        if body.is_of_bodies:
            continue
        particles = body.particles([*scenario.body])
        position = particles.position[particles.motion == FREE]
        height, dp = ground.height_above(position), body.spacing
        kept = height > LEAST_HEIGHT * dp
        share = kept.astype(float)
        near = np.abs(height) < NEAR * dp
        if near.any():
            steps = dp * ((np.arange(PARTS) + 0.5) / PARTS - 0.5)
            parts = np.stack(np.meshgrid(*[steps] * scenario.dim), axis=-1)
            places = position[near, None] + parts.reshape(-1, scenario.dim)
            above = ground.height_above(places.reshape(-1, scenario.dim)) * PARTS / dp
            share[near] = np.clip(0.5 + above, 0, 1).reshape(len(places), -1).mean(axis=1)
        cell = dp**scenario.dim
        found[name] = float(share.sum() * cell), float(kept.sum() * cell)
    return found
