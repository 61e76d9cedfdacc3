"""Maps of a run that made none while it went on: from its snapshots."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...errors import UserError
from ...geodata.grid import Raster
from ...record.reader import Run, Snapshot
from .files import rasters_of
from .grid import MapSettings
from .peaks import Peaks, gravity_of
from .standing import clamped_bodies, flowing

KEYS = ("id", "position", "velocity", "mass", "density", "motion", "body", "grain")


def maps_from_snapshots(run: Run, grid: Raster, settings: MapSettings) -> dict[str, Raster]:
    """Every map, by the snapshots alone: what peaked between two of them is missed.

    Raises:
        UserError: the run has no snapshot, or is 2-D.

    """
    if run.scenario["dim"] != 3:
        raise UserError(f"{run.directory}: a 2-D run has no map")
    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot yet")
    gravity = gravity_of(np.array(run.scenario.get("gravity", [0.0])))
    peaks = Peaks(grid, settings.dry_below, gravity, run.periods())
    state: Mapping[str, np.ndarray] = {}
    for snapshot in run:
        state = flowing_in(run, snapshot)
        peaks.look(snapshot.time, state)
    return rasters_of(peaks, state, settings)


def flowing_in(run: Run, snapshot: Snapshot) -> dict[str, np.ndarray]:
    """What of a snapshot maps show."""
    snapshot.prefetch(KEYS)
    fields = {key: snapshot.stored(key) for key in KEYS}
    return flowing(fields, clamped_bodies(snapshot.body_names, run.scenario.get("body", {})))
