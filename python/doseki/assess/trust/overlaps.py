"""Which overlaps of bodies tell whether their contacts are stiff enough."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...record.particles import BOUND
from ...record.reader import Snapshot
from ...scenario.kinematics import DEFORM


def overlaps_of_rigid(scenario: Mapping[str, Any], snapshot: Snapshot) -> np.ndarray:
    """The overlaps (n,), over the diameter, of rigid bodies that touch no body that deforms.

    A contact with a body that deforms is as stiff as its material, whatever [contact] says.
    """
    tables = scenario.get("body", {}).items()
    deform = [name for name, body in tables if body.get("kinematics") in DEFORM]
    grains = snapshot.grains if deform else {}
    if not grains:
        return snapshot.overlaps()
    rigid = ~np.isin(grains["body"], deform)
    soft = (snapshot["motion"] == BOUND) & np.isin(snapshot["body"], deform)
    if soft.any():
        from scipy.spatial import cKDTree

        apart = cKDTree(snapshot["position"][soft]).query(grains["position"])[0]
        rigid &= apart > 0.5 * grains["diameter"] + scenario["dp"]
    return np.asarray(grains["overlap"][rigid])
