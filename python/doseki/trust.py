"""How far a run can be trusted, judged afterwards from its record.

Each check is a pure function of a `Run` or of what `look` measured on its snapshots; docs/trust.md
says what is counted.  What the record cannot tell is "not available".
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from .findings import LEAST_ACROSS_FLOW, LEAST_ACROSS_GRAIN
from .loading import Run, Snapshot
from .materials import Material, complete_materials
from .measure import speed
from .overlaps import TOO_NEAR
from .particles import BOUND, DRIVEN, FIXED, FREE
from .record import jsonable
from .schemes import RESOLVED, UETA2022
from .storage import write_whole_text

GOOD, DOUBTFUL, BAD, NOT_AVAILABLE = "good", "doubtful", "bad", "not available"
MACH = (0.1, 0.3)  # speed over sound speed
DENSITY = (0.01, 0.05)  # |rho/rho0 - 1|
ENERGY = (0.01, 0.05)  # residual over the largest energy that took part
MOMENTUM = (1e-6, 1e-3)  # over that of all the mass at the highest kinetic energy
RESOLVED_MOMENTUM = (1e-3, 1e-2)  # shifting does not keep it to rounding
DEPTH = (float(LEAST_ACROSS_FLOW), LEAST_ACROSS_FLOW / 2)  # particles
CLOSEST = (0.5, TOO_NEAR)  # spacings
COLUMN = 4  # spacings, width of the columns in which depths are measured
RESOLVED_MACH = 0.1  # for which the resolved scheme chooses its sound speed
MOST_GRAINS = 20_000  # among which nearest pairs are sought
ENERGIES = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")


@dataclass(frozen=True)
class Check:
    """One finding: `limits` are those of good and of doubtful; `counted` says of what."""

    name: str
    value: float | None
    limits: tuple[float, float]
    verdict: str
    counted: str
    remedy: str = ""  # empty where the verdict is good
    details: dict[str, float] = field(default_factory=dict)


def verdict(value: float, limits: tuple[float, float]) -> str:
    """Good, doubtful or bad; limits that fall are lower bounds.  What is not a number is bad."""
    sign = 1 if limits[1] > limits[0] else -1
    good, doubtful = (sign * value < sign * limit * (1 + sign * 1e-9) for limit in limits)
    return GOOD if good else DOUBTFUL if doubtful else BAD


def _judged(
    name: str,
    value: float,
    limits: tuple[float, float],
    counted: str,
    remedy: str,
    **details: float,
) -> Check:
    found = verdict(value, limits)
    return Check(name, value, limits, found, counted, "" if found == GOOD else remedy, details)


def _unknown(name: str, limits: tuple[float, float], why: str) -> Check:
    return Check(name, None, limits, NOT_AVAILABLE, why)


@dataclass
class Seen:
    """What the snapshots of a run show, one entry for each that has such particles."""

    mach: list[float] = field(default_factory=list)
    density_highest: list[float] = field(default_factory=list)  # |rho/rho0 - 1|
    density_most: list[float] = field(default_factory=list)  # its 99th percentile
    depth: list[float] = field(default_factory=list)  # particles
    closest: list[float] = field(default_factory=list)  # spacings
    potential: list[float] = field(default_factory=list)  # J (2-D: J/m), -m g.x of free particles
    motions: set[int] = field(default_factory=set)
    overlap: list[float] = field(default_factory=list)  # largest of contacts, over the diameter
    walls_go: bool = False  # whether a fixed particle has a velocity
    too_many_grains: bool = False


def look(run: Run) -> Seen:
    """Measure every snapshot, one at a time."""
    seen = Seen()
    materials = complete_materials(run.scenario.get("material", {}))
    single = _single_grain_bodies(run.scenario)
    for snapshot in run:
        seen.motions |= set(np.unique(snapshot["motion"]).tolist())
        free = snapshot["motion"] == FREE
        if len(bodies := snapshot.grains):
            seen.overlap.append(float(np.max(bodies["overlap"])))
        seen.walls_go |= bool(np.any(snapshot["velocity"][snapshot["motion"] == FIXED]))
        gravity = np.array(_gravity(run.scenario))
        along = snapshot["position"][free] @ gravity
        seen.potential.append(float(-(snapshot["mass"][free] @ along)))
        if free.any():
            _look_at_free(seen, run.scenario, snapshot, free, materials)
            _look_at_grains(seen, snapshot, free & np.isin(snapshot["body"], single), materials)
    return seen


def _look_at_free(
    seen: Seen,
    scenario: Mapping[str, Any],
    snapshot: Snapshot,
    free: np.ndarray,
    materials: Mapping[str, Material],
) -> None:
    names = snapshot["material"][free]
    sound = scenario.get("xi", 1.0) * _of(names, materials, "speedsound")
    seen.mach.append(float(np.max(speed(snapshot["velocity"][free]) / sound)))
    fluid = _is_fluid(names, materials)
    strain = snapshot["density"][free] / _of(names, materials, "rho0") - 1
    clamped = _clamped(scenario, fluid, snapshot["pressure"][free])
    strain = np.where(clamped, np.maximum(strain, 0.0), np.abs(strain))
    seen.density_highest.append(float(strain.max()))
    seen.density_most.append(float(np.quantile(strain, 0.99)))
    if fluid.any():
        volume = snapshot["mass"][free][fluid] / _of(names[fluid], materials, "rho0")
        position = snapshot["position"][free][fluid]
        seen.depth.append(flow_depth(position, volume, scenario["dp"]))


def _look_at_grains(
    seen: Seen, snapshot: Snapshot, grain: np.ndarray, materials: Mapping[str, Material]
) -> None:
    grain = grain.copy()
    names = snapshot["material"]
    grain[grain] = ~_is_fluid(names[grain], materials)
    if grain.sum() > MOST_GRAINS:
        seen.too_many_grains = True
    elif grain.sum() > 1:
        volume = snapshot["mass"][grain] / _of(names[grain], materials, "rho0")
        spacing = float(volume.min()) ** (1 / snapshot.dim)
        seen.closest.append(closest_pair(snapshot["position"][grain]) / spacing)


def _of(names: np.ndarray, materials: Mapping[str, Material], parameter: str) -> np.ndarray:
    """A material parameter of each particle, unscaled, from the names of their materials."""
    unique, index = np.unique(names, return_inverse=True)
    return np.array([getattr(materials[str(name)], parameter) for name in unique])[index]


def _is_fluid(names: np.ndarray, materials: Mapping[str, Material]) -> np.ndarray:
    return np.isin(names, [name for name, entry in materials.items() if entry.law == "fluid"])


def _clamped(scenario: Mapping[str, Any], fluid: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Which particles have no pressure, hence no meaning, below rho0.

    In the resolved scheme those are particles of the free surface, whatever `tension` says.
    """
    if _is_resolved(scenario):
        return pressure == 0
    tension = scenario.get("tension", "clamp_fluid")
    return {"free": np.zeros_like(fluid), "clamp_fluid": fluid}.get(tension, np.ones_like(fluid))


def _single_grain_bodies(scenario: Mapping[str, Any]) -> list[str]:
    """Bodies whose particles are grains of their own: single ones, or all of unresolved grains."""
    diameter = scenario.get("parameters", {}).get("diameter", {})
    diameter = diameter.get("value") if isinstance(diameter, Mapping) else diameter
    known = isinstance(diameter, int | float)
    unresolved = known and diameter < LEAST_ACROSS_GRAIN * scenario["dp"]
    bodies = scenario.get("body", {}).items()
    return [name for name, body in bodies if unresolved or body.get("fill") == "single"]


def flow_depth(position: np.ndarray, volume: np.ndarray, dp: float) -> float:
    """Depth along the last axis in spacings: volume (m3; 2-D: m2) in columns over their section.

    Columns are COLUMN spacings wide; the depth is that of the column that the median particle is
    in, so that spray counts for little.
    """
    cells = np.floor(position[:, :-1] / (COLUMN * dp) + 1e-6).astype(np.int64)
    _, column = np.unique(cells, axis=0, return_inverse=True)
    column = column.ravel()
    section = (COLUMN * dp) ** cells.shape[1]
    depth = np.bincount(column, volume) / section / dp
    return float(np.median(depth[column]))


def closest_pair(position: np.ndarray) -> float:
    """Least distance between two of the points (N, dim), m; not across periodic sides."""
    axis = int(np.argmax(np.ptp(position, axis=0)))
    ordered = position[np.argsort(position[:, axis])]
    least = math.inf
    for step in range(1, len(ordered)):
        gap = ordered[step:] - ordered[:-step]
        if gap[:, axis].min() >= least:
            break
        least = min(least, float(np.linalg.norm(gap, axis=1).min()))
    return least


def mach_check(seen: Seen, xi: float, scheme: str = UETA2022) -> Check:
    """Speeds against the sound speed of the run."""
    if not seen.mach:
        return _unknown("Mach number", MACH, "no free particle in any snapshot")
    value = _highest(seen.mach)
    remedy = "see the failure"
    if math.isfinite(value):
        remedy = f"raise xi to {xi * value / MACH[0]:.2g}"
        if scheme == RESOLVED:
            remedy += f", that is speed_max {value / RESOLVED_MACH:.2g} times"
    return _judged(
        "Mach number", value, MACH, f"free particles of {len(seen.mach)} snapshots", remedy
    )


def density_check(seen: Seen, tension: str, xi: float, scheme: str = UETA2022) -> Check:
    """Compression against none; the verdict is on the 99th percentile."""
    name = "density fluctuation"
    if not seen.density_most:
        return _unknown(name, DENSITY, "no free particle in any snapshot")
    value = _highest(seen.density_most)
    what = {"free": "both signs", "clamp_fluid": "both signs of solids, compression of fluids"}
    signs = what.get(tension, "compression")
    if scheme == RESOLVED:
        signs = "both signs inside, compression of the free surface"
    counted = f"99th percentile of free particles, {signs}"
    raised = "speed_max" if scheme == RESOLVED else f"xi (now {xi:.3g})"
    remedy = f"raise {raised}; look for particles squeezed at the start or into walls"
    highest = _highest(seen.density_highest)
    return _judged(name, value, DENSITY, counted, remedy, highest=highest)


def energy_check(run: Run, seen: Seen) -> Check:
    """Kinetic + elastic + dissipated energy against start + work of gravity."""
    name = "energy balance"
    why = _incomplete(run, seen, name) or _wrapped(run.scenario) or _driven_by_walls(run, seen)
    if not why and BOUND in seen.motions:
        why = "what contacts of bodies take is not recorded"
    if why:
        return _unknown(name, ENERGY, why)
    columns = {column: run.history[column] for column in ENERGIES}
    totals = sum(columns.values())
    work = seen.potential[0] - seen.potential[-1]
    residual = float(totals[-1] - totals[0] - work)
    largest = max(abs(work), *(float(np.max(np.abs(values))) for values in columns.values()))
    value = abs(residual) / largest if largest else abs(residual)
    counted = "history from first to last row, work of gravity from the snapshots"
    counted += _left_in_residual(run)
    details = {"residual": residual, "gravity_work": work, "largest": largest}
    return _judged(name, value, ENERGY, counted, _energy_remedy(run.scenario), **details)


def _left_in_residual(run: Run) -> str:
    """What the energy balance leaves out, in words."""
    if _is_resolved(run.scenario):
        return (
            ", viscosity and walls in av_dissipation; what shifting and the smoothing of density"
            " and pressure took is not recorded and stands in the residual"
        )
    used = _used(run, complete_materials(_materials(run)))
    taken = ["viscosity nu"] * any(m.law == "fluid" and m.nu > 0 for m in used)
    taken += ["yielding"] * any(m.yield_strength or m.cohesion or m.friction_angle for m in used)
    if taken:
        return f"; what {' and '.join(taken)} took is not recorded and stands in the residual"
    return ""


def _energy_remedy(scenario: Mapping[str, Any]) -> str:
    if _is_resolved(scenario):
        return "raise speed_max, then lower dp; shifting = false tells what shifting takes"
    return f"lower cflnumber (now {scenario.get('cflnumber', 0.1):g}) and cfl_force by half"


def _driven_by_walls(run: Run, seen: Seen) -> str:
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
    why = _incomplete(run, seen, name)
    if not why and seen.motions - {FREE, BOUND}:
        why = "walls take part: not checked"
    if why:
        return _unknown(name, MOMENTUM, why)
    resolved = _is_resolved(run.scenario)
    history, gravity = run.history, _gravity(run.scenario)
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
    return _judged(name, value, limits, counted, remedy, drift=drift, scale=scale)


def depth_check(run: Run, seen: Seen) -> Check:
    """Particles over the depth of the fluid."""
    name, dp = "particles per flow depth", run.scenario["dp"]
    if not seen.depth:
        return _unknown(name, DEPTH, "no free fluid")
    if not any(_gravity(run.scenario)):
        return _unknown(name, DEPTH, "no gravity, hence no depth")
    value = float(np.median(seen.depth))
    counted = f"columns of fluid along the last axis, median of {len(seen.depth)} snapshots"
    remedy = f"dp = {dp * value / DEPTH[0]:.2g} would resolve the flow"
    return _judged(name, value, DEPTH, counted, remedy, least=float(np.min(seen.depth)))


def contact_check(seen: Seen, xi: float) -> Check:
    """Closest approach of grains of one particle, in spacings: the scheme has no contact law."""
    name = "closest approach"
    if seen.too_many_grains:
        return _unknown(name, CLOSEST, f"more than {MOST_GRAINS} grains")
    if not seen.closest:
        return _unknown(name, CLOSEST, "no two free solid grains of one particle")
    counted = f"free solid grains of one particle in {len(seen.closest)} snapshots, over spacing"
    remedy = f"raise xi (now {xi:.3g}), or resolve the grains: {LEAST_ACROSS_GRAIN} dp across"
    return _judged(name, float(np.min(seen.closest)), CLOSEST, counted, remedy)


def overlap_check(run: Run, seen: Seen) -> Check:
    """How far bodies are pressed into one another, against what contacts are stiff enough for."""
    name, contact = "overlap of contacts", run.scenario.get("contact", {})
    allowed = float(contact.get("overlap", 0.01))
    limits = (allowed, 5 * allowed)
    value = _highest(seen.overlap)
    counted = f"bodies that move in {len(seen.overlap)} snapshots, over the diameter"
    remedy = f"raise contact.speed {max(value / allowed, 1):.2g} times"
    return _judged(name, value, limits, counted, remedy)


def trust_checks(run: Run) -> list[Check]:
    """Every check of a recorded run."""
    seen, scenario = look(run), run.scenario
    xi, tension = scenario.get("xi", 1.0), scenario.get("tension", "clamp_fluid")
    scheme = scenario.get("scheme", UETA2022)
    return [
        mach_check(seen, xi, scheme),
        density_check(seen, tension, xi, scheme),
        energy_check(run, seen),
        momentum_check(run, seen),
        depth_check(run, seen),
        contact_check(seen, xi),
        *([overlap_check(run, seen)] if seen.overlap else []),
    ]


def write_trust(run: Run) -> list[Check]:
    """Judge a run and put the report into DIR/trust.json."""
    checks = trust_checks(run)
    report = {"verdict": overall(checks), "checks": [asdict(check) for check in checks]}
    text = json.dumps(jsonable(report), indent=2, allow_nan=False) + "\n"
    write_whole_text(run.folder.trust, text)
    return checks


def overall(checks: list[Check]) -> str:
    """The worst of the verdicts."""
    found = {check.verdict for check in checks}
    return next((word for word in (BAD, DOUBTFUL, GOOD) if word in found), NOT_AVAILABLE)


def trust_lines(report: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """(verdict, text) of a report as read from trust.json; good checks share a line."""
    checks = report["checks"]
    for word in (BAD, DOUBTFUL):
        for check in checks:
            if check["verdict"] == word:
                limit = check["limits"][0]
                said = f"{_said(check)}, good is {limit:.3g}: {check['remedy']}"
                yield word, said
    good = [_said(check) for check in checks if check["verdict"] == GOOD]
    unknown = [check["name"] for check in checks if check["verdict"] == NOT_AVAILABLE]
    yield from (
        (word, "; ".join(of)) for word, of in ((GOOD, good), (NOT_AVAILABLE, unknown)) if of
    )


def _said(check: Mapping[str, Any]) -> str:
    value = check["value"]
    return f"{check['name']} {'not finite' if value is None else format(value, '.2g')}"


def _highest(values: list[float]) -> float:
    """The highest value; nan if any is nan."""
    return float(np.max(values))


def _is_resolved(scenario: Mapping[str, Any]) -> bool:
    return scenario.get("scheme", UETA2022) == RESOLVED


def _gravity(scenario: Mapping[str, Any]) -> list[float]:
    return list(scenario.get("gravity", [0.0] * scenario["dim"]))


def _materials(run: Run) -> dict[str, Any]:
    return run.scenario.get("material", {})


def _used(run: Run, materials: Mapping[str, Material]) -> list[Material]:
    return [materials[name] for name in run[-1].material_names]


def _incomplete(run: Run, seen: Seen, name: str) -> str:
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


def _wrapped(scenario: Mapping[str, Any]) -> str:
    """Why the work of gravity cannot be told from positions; empty if it can."""
    axes = zip("xyz", _gravity(scenario), strict=False)
    if any(g and axis in scenario.get("periodic", []) for axis, g in axes):
        return "gravity acts along a periodic axis: its work is not recorded"
    return ""
