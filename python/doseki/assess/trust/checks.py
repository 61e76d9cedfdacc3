"""Checks of single quantities against limits: pure functions of what `look` saw."""

from __future__ import annotations

import math

import numpy as np

from ...record.reader import Run
from ...scenario.schemes import RESOLVED, UETA2022
from ...scene.checks.particle_overlaps import TOO_NEAR
from ...util.finding import rounded_up
from ..sound_speed import raised
from ..warnings import MIN_ACROSS_FLOW, MIN_ACROSS_GRAIN
from .snapshots import Seen, gravity_of
from .verdicts import Check, judged, max_of, unknown

MACH = (0.1, 0.3)  # speed over sound speed
DENSITY = (0.01, 0.05)  # |rho/rho0 - 1|
DEPTH = (float(MIN_ACROSS_FLOW), MIN_ACROSS_FLOW / 2)  # particles
CLOSEST = (0.5, TOO_NEAR)  # spacings


def mach_check(seen: Seen, key: str, given: float) -> Check:
    """Speeds against the sound speed; the verdict is on the 99th percentile, not on one drop."""
    if not seen.mach_most:
        return unknown("Mach number", MACH, "no free particle in any snapshot")
    value, highest = max_of(seen.mach_most), max_of(seen.mach_highest)
    remedy = "see the failure"
    if math.isfinite(value):
        remedy = f"set {raised(key, given, value / MACH[0])}"
    counted = f"99th percentile of free particles in {len(seen.mach_most)} snapshots"
    return judged("Mach number", value, MACH, counted, remedy, highest=highest)


def density_check(
    seen: Seen, tension: str, key: str, given: float, scheme: str = UETA2022
) -> Check:
    """Compression against none; the verdict is on the 99th percentile."""
    name = "density fluctuation"
    if not seen.density_most:
        return unknown(name, DENSITY, "no free particle in any snapshot")
    value = max_of(seen.density_most)
    what = {"free": "both signs", "clamp_fluid": "both signs of solids, compression of fluids"}
    signs = what.get(tension, "compression")
    if scheme == RESOLVED:
        signs = "both signs inside, compression of the free surface"
    counted = f"99th percentile of free particles, {signs}"
    remedy = f"raise {key} (now {given:.3g}); look for particles squeezed at first or into walls"
    largest = max_of(seen.density_highest)
    return judged(name, value, DENSITY, counted, remedy, highest=largest)


def depth_check(run: Run, seen: Seen) -> Check:
    """Particles over the depth of the fluid."""
    name, dp = "particles per flow depth", run.scenario["dp"]
    if not seen.depth:
        return unknown(name, DEPTH, "no free fluid")
    if not any(gravity_of(run.scenario)):
        return unknown(name, DEPTH, "no gravity, hence no depth")
    value = float(np.median(seen.depth))
    counted = f"columns of fluid along the last axis, median of {len(seen.depth)} snapshots"
    remedy = f"dp = {dp * value / DEPTH[0]:.2g} would resolve the flow"
    return judged(name, value, DEPTH, counted, remedy, least=float(np.min(seen.depth)))


def contact_check(seen: Seen, key: str, given: float) -> Check:
    """Closest approach of grains of one particle, in spacings: the scheme has no contact law."""
    name = "closest approach"
    if not seen.closest:
        return unknown(name, CLOSEST, "no two free solid grains of one particle")
    counted = f"free solid grains of one particle in {len(seen.closest)} snapshots, over spacing"
    remedy = f"raise {key} (now {given:.3g}), or resolve the grains: {MIN_ACROSS_GRAIN} dp across"
    return judged(name, float(np.min(seen.closest)), CLOSEST, counted, remedy)


def overlap_check(run: Run, seen: Seen) -> Check:
    """How far rigid bodies are pressed into one another, against what contacts are stiff for.

    A collision is over between two snapshots: the core keeps the largest overlap since the start.
    """
    name, contact = "overlap of contacts", run.scenario.get("contact", {})
    allowed = float(contact.get("overlap", 0.01))
    limits = (allowed, 5 * allowed)
    kept = run.summary.get("largest_overlap")
    kept = kept if isinstance(kept, int | float) else None
    if not seen.overlap and not kept:
        why = "no snapshot has a rigid body that touches neither one that deforms nor dust;"
        why += " contacts with what deforms are as stiff as its material"
        return unknown(name, limits, why)
    value = max_of([*seen.overlap, *([] if kept is None else [float(kept)])])
    remedy = f"raise contact.speed {max(rounded_up(value / allowed), 1.1):g} times"
    if contact.get("stiffness") == "material":
        remedy = "contacts are as stiff as the material: see young_modulus and speeds of impact"
    return judged(name, value, limits, _overlap_counted(run, seen, kept is not None), remedy)


def _overlap_counted(run: Run, seen: Seen, has_kept: bool) -> str:
    """What the largest overlap was looked for in; a summary may be of an end before this one."""
    alone = f"{len(seen.overlap)} snapshots alone, between which were others"
    looked = "the whole run" if has_kept else alone
    said = f"rigid bodies that move, largest of {looked}, over the diameter, without those that"
    said += " touch a body that deforms, or dust"
    end = run.summary.get("time")
    if has_kept and isinstance(end, int | float) and run.times[-1] > end * (1 + 1e-9):
        return said + f"; after {end:.6g} s snapshots alone"
    return said
