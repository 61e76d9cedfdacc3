"""What of a state maps show: not structures that deform, and of bodies how they get along."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...record.particles import BOUND

KEYS = ("body", "grain", "mass", "motion", "velocity")  # of a state


def clamped_bodies(names: Sequence[str], tables: Mapping[str, Mapping[str, Any]]) -> np.ndarray:
    """Indices of the named bodies whose tables have points that are clamped."""
    return np.array([k for k, name in enumerate(names) if "clamped" in tables.get(name, {})], int)


def standing(state: Mapping[str, np.ndarray], clamped: np.ndarray) -> np.ndarray:
    """Mask (N,) of the particles of those bodies that hang together with a clamped point.

    A clamped point has no velocity at all, others tremble. What has broken off is a body of its
    own and flows. `state` has fields as record.fields has them, with indices of bodies.
    """
    own = np.isin(state["body"], clamped) & (state["motion"] == BOUND)
    part = np.stack([state["body"][own], state["grain"][own]])
    held = part[:, ~state["velocity"][own].any(axis=1)]
    mask = np.zeros(len(own), bool)
    mask[own] = (part[:, :, None] == np.unique(held, axis=1)[:, None]).all(axis=0).any(axis=1)
    return mask


def flowing(state: Mapping[str, np.ndarray], clamped: np.ndarray) -> dict[str, np.ndarray]:
    """The rest of a state, where each particle of a body has the velocity of its centre of mass.

    The upper side of a boulder that rolls is twice as fast as the boulder gets along.
    """
    rest = dict(state)
    if len(clamped):
        flows = ~standing(state, clamped)
        rest = {key: values[flows] for key, values in state.items() if len(values) == len(flows)}
    return rest | {"velocity": _of_centres(rest)}


def _of_centres(state: Mapping[str, np.ndarray]) -> np.ndarray:
    velocity = state["velocity"]
    own = np.flatnonzero((state["motion"] == BOUND) & (state["grain"] >= 0))
    if not len(own):
        return velocity
    grain = state["grain"][own].astype(np.int64)
    key = state["body"][own].astype(np.int64) * (grain.max() + 1) + grain
    body, mass = np.unique(key, return_inverse=True)[1], state["mass"][own]
    total = np.bincount(body, mass)
    velocity = velocity.copy()
    for axis in velocity.T:
        axis[own] = (np.bincount(body, mass * axis[own]) / total)[body]
    return velocity
