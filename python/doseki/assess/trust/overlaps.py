"""Which overlaps of bodies tell whether their contacts are stiff enough."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...record.particles import BOUND
from ...record.reader import Snapshot
from ...scenario.kinematics import BREAKABLE, DEFORM

DUST = {2: 4, 3: 8}  # particles; parts of fewer are dust, which is born where there is little room


def overlaps_of_rigid(scenario: Mapping[str, Any], snapshot: Snapshot) -> np.ndarray:
    """The overlaps (n,), over the diameter, of rigid bodies that touch none that deforms, nor dust.

    A contact with a body that deforms is as stiff as its material, whatever [contact] says.  A
    breakable body is one that deforms while it does.
    """
    kinds = {name: body.get("kinematics") for name, body in scenario.get("body", {}).items()}
    deform = [name for name, kind in kinds.items() if kind in DEFORM]
    grains = snapshot.grains if deform else {}
    if not grains:
        return snapshot.overlaps()
    rigid = ~np.isin(grains["body"], deform)
    breakable = [name for name in deform if kinds[name] == BREAKABLE.name]
    rigid |= np.isin(grains["body"], breakable) & _is_rigid(snapshot, len(rigid))
    soft = (snapshot["motion"] == BOUND) & np.isin(snapshot["body"], deform)
    soft &= ~np.append(rigid, False)[snapshot["grain"]]  # the last: of those of no row, -1
    if soft.any():
        from scipy.spatial import cKDTree

        apart = cKDTree(snapshot["position"][soft]).query(grains["position"])[0]
        rigid &= apart > 0.5 * grains["diameter"] + scenario["dp"]
    return np.asarray(grains["overlap"][rigid])


def _is_rigid(snapshot: Snapshot, rows: int) -> np.ndarray:
    """Mask (rows,) of the bodies with nothing but the pressure of water on any particle."""
    own = snapshot["grain"] >= 0
    grain = snapshot["grain"][own]
    stress = snapshot["stress"][own] + snapshot["pressure"][own, None, None] * np.eye(3)
    strained = np.bincount(grain, stress.any(axis=(1, 2)), rows)
    return (strained == 0) & (np.bincount(grain, minlength=rows) >= DUST[snapshot.dim])
