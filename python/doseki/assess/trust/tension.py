"""Where water hangs on the bounds of its tension (docs/equations.md, eq. 85)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...compiled import load_core
from ...record.particles import BOUND, FREE
from ...record.reader import Snapshot
from ...scenario.materials import Material, equation_of_state
from ...scenario.schemes import KERNEL_SUPPORT, RESOLVED, RESOLVED_KERNEL
from .verdicts import Check, judged, unknown

TENSION = (0.001, 0.02)  # share of the fluid
NEAR = 1e-3  # relative: nearer to a bound, a pressure is on it
NAMED = 3  # bodies that a finding names


@dataclass(frozen=True)
class Hanging:
    """What of the fluid is on a bound in one snapshot."""

    time: float  # s
    share: float  # of the particles of fluid
    bodies: tuple[str, ...]  # those nearest to it, the most frequent first


def hanging(
    scenario: Mapping[str, Any], snapshot: Snapshot, materials: Mapping[str, Material]
) -> Hanging | None:
    """The fluid of a snapshot that can bear no more tension; None without fluid."""
    names = np.asarray(snapshot["material"])
    liquids = [name for name, entry in materials.items() if entry.law == "fluid"]
    fluid = np.flatnonzero((snapshot["motion"] == FREE) & np.isin(names, liquids))
    if not len(fluid):
        return None
    stretched = fluid[snapshot["pressure"][fluid] < 0]  # a free surface has none below rho0
    walls = np.flatnonzero(snapshot["motion"] != FREE)
    distance, nearest = _nearest(snapshot, stretched, walls)
    kernel = scenario.get("kernel", RESOLVED_KERNEL)
    reach = KERNEL_SUPPORT[kernel] * snapshot["smoothing_length"][stretched]
    at_body = (distance < reach) & (snapshot["motion"][nearest] == BOUND)
    bound = _bounds(scenario, names[stretched], materials, at_body)
    on_bound = snapshot["pressure"][stretched] <= bound * (1 - NEAR)
    bodies = Counter(np.asarray(snapshot["body"])[nearest[on_bound]].tolist())
    named = tuple(str(name) for name, _ in bodies.most_common(NAMED)) if len(walls) else ()
    return Hanging(float(snapshot.time), float(on_bound.sum()) / len(fluid), named)


def _nearest(
    snapshot: Snapshot, of: np.ndarray, among: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distance (n,), m, to the nearest of some particles, and which that is."""
    from scipy.spatial import cKDTree

    if not len(among) or not len(of):
        return np.full(len(of), np.inf), np.zeros(len(of), np.int64)
    distance, index = cKDTree(snapshot["position"][among]).query(snapshot["position"][of])
    return distance, among[index]


def _bounds(
    scenario: Mapping[str, Any],
    names: np.ndarray,
    materials: Mapping[str, Material],
    at_body: np.ndarray,
) -> np.ndarray:
    """The least pressure, Pa, that each particle can have."""
    bounds = np.zeros(len(names))
    eos = equation_of_state(RESOLVED, scenario.get("eos", "linear"))
    for name in np.unique(names):
        liquid = materials[str(name)]
        least = _least_pressure(liquid.scaled(scenario.get("xi", 1.0)), eos)
        in_flow = max(liquid.cavitation_pressure, least)
        bearable = np.where(at_body, max(in_flow, -liquid.air_entry_suction), in_flow)
        bounds = np.where(names == name, bearable, bounds)
    return bounds


def _least_pressure(liquid: Material, eos: str) -> float:
    """Pressure, Pa, at the least density that the scheme lets a liquid have."""
    physics, table = load_core().physics, liquid.table()
    parameters = [[table[name]] for name in physics.equations_of_state[eos]]
    density = physics.least_relative_density * liquid.rho0
    pressure, _, _ = getattr(physics, eos)([[density], *parameters])
    return pressure[0]


def tension_check(seen: list[Hanging]) -> Check:
    """How much of the fluid is on a bound of its tension, since when, and near which bodies."""
    name = "water on its bound of tension"
    if not seen:
        return unknown(name, TENSION, "no free fluid in any snapshot")
    worst = max(seen, key=lambda each: each.share)
    since = next((each.time for each in seen if each.share > TENSION[0]), worst.time)
    near = f" near {', '.join(worst.bodies)}" if worst.bodies else ""
    remedy = (
        f"since {since:.3g} s{near}: voids open there; give air_entry_suction of the liquid, Pa,"
        " where water between bodies should hold more, or cavitation_pressure"
    )
    counted = f"share of the fluid in {len(seen)} snapshots"
    return judged(name, worst.share, TENSION, counted, remedy, since=since)
