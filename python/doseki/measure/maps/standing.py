"""Structures that deform: clamped bodies, which no map counts as part of the flow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...record.particles import BOUND

KEYS = ("body", "grain", "motion", "velocity")  # of a state


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
    """The rest of a state."""
    if not len(clamped):
        return dict(state)
    rest = ~standing(state, clamped)
    return {key: values[rest] for key, values in state.items() if len(values) == len(rest)}
