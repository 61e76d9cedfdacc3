"""What the snapshots of a run show: speeds, densities, depths, distances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...measure.numbers import speed
from ...measure.views import materials_of
from ...record.particles import BOUND, FIXED, FREE
from ...record.reader import Run, Snapshot
from ...scenario.materials import Material
from ...scenario.schemes import RESOLVED, UETA2022
from ..warnings import MIN_ACROSS_GRAIN
from .overlaps import overlaps_of_rigid
from .tension import Hanging, hanging

FIELDS = (  # that the checks of every snapshot read
    "position", "velocity", "mass", "density", "pressure", "smoothing_length", "material", "body",
    "motion",
)  # fmt: skip
COLUMN = 4  # spacings, width of the columns in which depths are measured


@dataclass
class Seen:
    """What the snapshots of a run show, one entry for each that has such particles."""

    mach_highest: list[float] = field(default_factory=list)
    mach_most: list[float] = field(default_factory=list)  # its 99th percentile
    density_highest: list[float] = field(default_factory=list)  # |rho/rho0 - 1|
    density_most: list[float] = field(default_factory=list)  # its 99th percentile
    depth: list[float] = field(default_factory=list)  # particles
    closest: list[float] = field(default_factory=list)  # spacings
    potential: list[float] = field(default_factory=list)  # J (2-D: J/m), -m g.x of free particles
    motions: set[int] = field(default_factory=set)
    overlap: list[float] = field(default_factory=list)  # largest of contacts, over the diameter
    # Of deformable bodies alone: kinetic and potential energy, J (2-D: J/m); angular momentum about
    # the centre of mass, (3,), kg m2/s (2-D: kg m/s), and what it would be if all went around.
    body_energy: list[float] = field(default_factory=list)
    angular_momentum: list[np.ndarray] = field(default_factory=list)
    angular_scale: list[float] = field(default_factory=list)
    tension: list[Hanging] = field(default_factory=list)  # resolved scheme
    bodies_move: bool = False  # whether there is a body that moves as a whole
    walls_go: bool = False  # whether a fixed particle has a velocity


def look(run: Run) -> Seen:
    """Measure every snapshot, one at a time."""
    seen = Seen()
    materials = materials_of(run)
    single = _single_grain_bodies(run.scenario)
    for snapshot in run:
        snapshot.prefetch(FIELDS)
        seen.motions |= set(np.unique(snapshot["motion"]).tolist())
        free = snapshot["motion"] == FREE
        seen.bodies_move |= len(snapshot.overlaps()) > 0
        if len(overlaps := overlaps_of_rigid(run.scenario, snapshot)):
            seen.overlap.append(float(overlaps.max()))
        seen.walls_go |= bool(np.any(snapshot["velocity"][snapshot["motion"] == FIXED]))
        gravity = np.array(gravity_of(run.scenario))
        along = snapshot["position"][free] @ gravity
        if is_of_deformable_bodies(snapshot):
            _look_at_deformable(seen, snapshot, gravity)
        seen.potential.append(float(-(snapshot["mass"][free] @ along)))
        hangs = hanging(run.scenario, snapshot, materials) if is_resolved(run.scenario) else None
        seen.tension += [hangs] if hangs is not None else []
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
    mach = speed(snapshot["velocity"][free]) / sound
    seen.mach_highest.append(float(mach.max()))
    seen.mach_most.append(float(np.quantile(mach, 0.99, method="higher")))
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


def is_of_deformable_bodies(snapshot: Snapshot) -> bool:
    """Whether nothing moves in a snapshot but deformable bodies."""
    moves = snapshot["motion"] != FIXED
    return bool(np.all(snapshot["motion"][moves] == BOUND)) and not len(snapshot.grains)


def _look_at_deformable(seen: Seen, snapshot: Snapshot, gravity: np.ndarray) -> None:
    bound = snapshot["motion"] == BOUND
    mass, x, v = (snapshot[key][bound] for key in ("mass", "position", "velocity"))
    energy = 0.5 * mass @ (v**2).sum(axis=1) - mass @ (x @ gravity)
    seen.body_energy.append(float(energy))
    total = mass.sum() or 1.0
    arm, own = x - mass @ x / total, v - mass @ v / total
    arm, own = (np.pad(of, ((0, 0), (0, 3 - of.shape[1]))) for of in (arm, own))
    seen.angular_momentum.append(mass @ np.cross(arm, own))
    seen.angular_scale.append(
        float(mass @ (np.linalg.norm(arm, axis=1) * np.linalg.norm(own, axis=1)))
    )


def _look_at_grains(
    seen: Seen, snapshot: Snapshot, grain: np.ndarray, materials: Mapping[str, Material]
) -> None:
    grain = grain.copy()
    names = snapshot["material"]
    grain[grain] = ~_is_fluid(names[grain], materials)
    if grain.sum() > 1:
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
    if is_resolved(scenario):
        return pressure == 0
    tension = scenario.get("tension", "clamp_fluid")
    return {"free": np.zeros_like(fluid), "clamp_fluid": fluid}.get(tension, np.ones_like(fluid))


def _single_grain_bodies(scenario: Mapping[str, Any]) -> list[str]:
    """Bodies whose particles are grains of their own: single ones, or all of unresolved grains."""
    diameter = scenario.get("parameters", {}).get("diameter", {})
    diameter = diameter.get("value") if isinstance(diameter, Mapping) else diameter
    known = isinstance(diameter, int | float)
    unresolved = known and diameter < MIN_ACROSS_GRAIN * scenario["dp"]
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
    from scipy.spatial import cKDTree

    distance, _ = cKDTree(position).query(position, k=2)  # the first is the point itself
    return float(distance[:, 1].min())


def is_resolved(scenario: Mapping[str, Any]) -> bool:
    return scenario.get("scheme", UETA2022) == RESOLVED


def gravity_of(scenario: Mapping[str, Any]) -> list[float]:
    return list(scenario.get("gravity", [0.0] * scenario["dim"]))
