"""What runs of deformable bodies alone must conserve: energy and angular momentum."""

from __future__ import annotations

import numpy as np

from ...record.particles import FIXED
from ...record.reader import Run
from .balances import incomplete, is_clamped, loses_sight, works_on
from .snapshots import Seen
from .verdicts import Check, judged, unknown

ENERGY = (0.01, 0.05)  # gained, over the largest energy that took part
ANGULAR = (1e-9, 1e-6)  # over that of all the mass going around at its speed


def deformable_checks(run: Run, seen: Seen) -> list[Check]:
    """Checks of a run in which nothing moves but deformable bodies; of others, none."""
    if not seen.body_energy or len(seen.body_energy) != len(run.times):
        return []
    return [_energy_check(run, seen), _angular_check(run, seen)]


def _energy_check(run: Run, seen: Seen) -> Check:
    """Kinetic + strain + potential energy against the start: nothing gives any."""
    name = "energy gained"
    why = incomplete(run, seen, name) or loses_sight(run.scenario) or works_on(run, seen)
    if why:
        return unknown(name, ENERGY, why)
    history = run.history
    elastic = history.get("elastic_energy", history["shear_energy"])  # the latter in older records
    strain = np.interp(run.times, history["time"], elastic)
    total = np.array(seen.body_energy) + strain
    change = total - total[0]
    motion = np.max(history["kinetic_energy"] + elastic)
    largest = float(max(motion, np.ptp(seen.body_energy)))
    gained = float(change.max())
    counted = f"motion, strain and weight in {len(total)} snapshots; cracks, damping and friction"
    counted += " only take"
    details = {"gained": gained, "taken": float(-change[-1]), "largest": largest}
    remedy = "this is a mistake in doseki, or a body is strained beyond its law: report it"
    return judged(name, gained / largest if largest else gained, ENERGY, counted, remedy, **details)


def _angular_check(run: Run, seen: Seen) -> Check:
    """Angular momentum about the centre of mass against that of the start."""
    name = "angular momentum"
    why = incomplete(run, seen, name)
    if not why and (FIXED in seen.motions or is_clamped(run)):
        why = "walls or clamped points take part: not checked"
    if not why and run.scenario.get("periodic", []):
        why = "places are not known beyond periodic sides"
    if why:
        return unknown(name, ANGULAR, why)
    change = np.array(seen.angular_momentum) - seen.angular_momentum[0]
    drift = float(np.max(np.linalg.norm(change, axis=1)))
    scale = float(np.max(seen.angular_scale))
    counted = f"about the centre of mass in {len(seen.angular_momentum)} snapshots"
    value = drift / scale if scale else drift
    remedy = "this is a mistake in doseki: report it"
    return judged(name, value, ANGULAR, counted, remedy, drift=drift, scale=scale)
