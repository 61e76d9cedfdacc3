"""Checks of what a run must conserve: energy and momentum.

A run of the resolved scheme keeps an account of what goes in and out (ledger.py); of others it
follows from positions and from the time alone, where nothing but gravity acts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...measure.views import materials_of
from ...record.particles import BOUND, DRIVEN, FREE
from ...record.reader import Run
from ...scenario.materials import Material
from ..sound_speed import sound_speed_from
from .ledger import ledger_of
from .snapshots import Seen, gravity_of, is_resolved
from .verdicts import Check, judged, unknown

ENERGY = (0.01, 0.05)  # residual over the largest energy that took part
MOMENTUM = (1e-6, 1e-3)  # over that of all the mass at the highest kinetic energy
RESOLVED_MOMENTUM = (1e-3, 1e-2)  # shifting does not keep it to rounding
PRESSED = 1e-9  # overlap of contacts over the diameter: more is no rounding
ENERGIES = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")


def energy_check(run: Run, seen: Seen) -> Check:
    """Kinetic + elastic + dissipated energy against start + work of gravity."""
    name = "energy balance"
    if (ledger := ledger_of(run)) is not None:
        return ledger.energy_check(name, ENERGY)
    why = incomplete(run, seen, name) or loses_sight(run.scenario) or works_on(run, seen)
    if not why and BOUND in seen.motions:
        why = "what contacts of bodies take is not recorded"
    if why:
        return unknown(name, ENERGY, why)
    columns = {column: run.history[column] for column in ENERGIES}
    totals = np.sum(list(columns.values()), axis=0)
    work = seen.potential[0] - seen.potential[-1]
    residual = float(totals[-1] - totals[0] - work)
    largest = max(abs(work), *(float(np.max(np.abs(values))) for values in columns.values()))
    value = abs(residual) / largest if largest else abs(residual)
    counted = "history from first to last row, work of gravity from the snapshots"
    counted += _left_in_residual(run)
    details = {"residual": residual, "gravity_work": work, "largest": largest}
    return judged(name, value, ENERGY, counted, _energy_remedy(run), **details)


def _left_in_residual(run: Run) -> str:
    """What the energy balance leaves out, in words."""
    if is_resolved(run.scenario):
        return (
            ", viscosity and walls in av_dissipation; what shifting and the smoothing of density"
            " and pressure took is not recorded and stands in the residual"
        )
    used = _used(run, materials_of(run))
    taken = ["viscosity nu"] * any(m.law == "fluid" and m.nu > 0 for m in used)
    taken += ["yielding"] * any(m.yield_strength or m.cohesion or m.friction_angle for m in used)
    if taken:
        return f"; what {' and '.join(taken)} took is not recorded and stands in the residual"
    return ""


def _energy_remedy(run: Run) -> str:
    cflnumber = run.scenario.get("cflnumber", 0.1)
    if is_resolved(run.scenario):
        key, _ = sound_speed_from(run)
        remedy = f"raise {key}, then lower dp; lower cflnumber (now {cflnumber:g}) by half"
        return f"{remedy}; shifting = false tells what shifting takes"
    return f"lower cflnumber (now {cflnumber:g}) and cfl_force by half"


def works_on(run: Run, seen: Seen) -> str:
    """What walls do that no energy is recorded of; empty if nothing."""
    if seen.walls_go:
        return "the work of walls that move is not recorded"
    bodies = run.scenario.get("body", {}).values()
    if any(body.get("wall") == "rough" and body.get("enabled", True) for body in bodies):
        return "the friction of rough walls is not recorded"
    return ""


def momentum_check(run: Run, seen: Seen) -> Check:
    """Momentum against that of the start and the impulse of gravity, m g t."""
    name = "momentum"
    if (ledger := ledger_of(run)) is not None and not is_clamped(run):
        return ledger.momentum_check(name, RESOLVED_MOMENTUM)
    why = incomplete(run, seen, name)
    if not why and seen.motions - {FREE, BOUND}:
        why = "walls take part: not checked"
    if not why and is_clamped(run):
        why = "clamped points take part: not checked"
    if why:
        return unknown(name, MOMENTUM, why)
    resolved = is_resolved(run.scenario)
    history, gravity = run.history, gravity_of(run.scenario)
    mass, time = history["mass"], history["time"] - history["time"][0]
    drifts = []
    for axis, g in zip("xyz", gravity, strict=False):
        momentum = history[f"momentum_{axis}"]
        drifts.append(momentum - momentum[0] - mass[0] * g * time)
    drift = float(np.max(np.linalg.norm(drifts, axis=0)))
    scale = math.sqrt(2 * float(np.max(mass)) * float(np.max(history["kinetic_energy"])))
    value = drift / scale if scale else drift
    remedy = 'use precision = "double"; otherwise this is a mistake in doseki: report it'
    if resolved:
        remedy = "lower dp: shifting does not keep it; shifting = false tells how much"
    counted = "all rows of the history" + (", less m g t" if any(gravity) else "")
    limits = RESOLVED_MOMENTUM if resolved else MOMENTUM
    return judged(name, value, limits, counted, remedy, drift=drift, scale=scale)


def contact_energy_check(run: Run, seen: Seen) -> list[Check]:
    """That contacts of bodies give no energy; of runs without an account or such bodies, none."""
    ledger = ledger_of(run)
    if ledger is None or not seen.bodies_move:
        return []
    bodies = run.scenario.get("body", {}).values()
    why = ""
    if seen.walls_go or any("motion" in body and body.get("enabled", True) for body in bodies):
        why = "walls that move give energy through contacts"
    elif run.scenario.get("start") or np.max(run[0].overlaps(), initial=0.0) > PRESSED:
        why = "contacts have energy at the start"
    return [ledger.contact_check("energy of contacts", why)]


def is_clamped(run: Run) -> bool:
    """Whether points of a body are held in place."""
    bodies = run.scenario.get("body", {}).values()
    return any("clamped" in body and body.get("enabled", True) for body in bodies)


def _used(run: Run, materials: Mapping[str, Material]) -> list[Material]:
    return [materials[name] for name in run[-1].material_names]


def incomplete(run: Run, seen: Seen, name: str) -> str:
    """Why the record does not hold all that a balance needs; empty if it does."""
    history = run.history
    if not len(history) or len(history["time"]) < 2 or len(seen.potential) < 2:
        return "fewer than two rows or snapshots"
    if not np.allclose(history["time"][[0, -1]], run.times[[0, -1]], rtol=1e-9, atol=0):
        return "history and snapshots do not span the same time"
    inflows = [
        part for part in run.scenario.get("inflow", {}).values() if part.get("enabled", True)
    ]
    if inflows or DRIVEN in seen.motions:
        return f"what the inflow carries and does is not recorded: no {name}"
    if history["mass_left"][-1] > 0:
        return f"what left carried is not recorded: no {name}"
    return ""


def loses_sight(scenario: Mapping[str, Any]) -> str:
    """Why the work of gravity cannot be told from positions; empty if it can."""
    axes = zip("xyz", gravity_of(scenario), strict=False)
    if any(g and axis in scenario.get("periodic", []) for axis, g in axes):
        return "gravity acts along a periodic axis: its work is not recorded"
    return ""
