"""The grains of a snapshot, and what is around them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ...record.particles import FIXED, FREE
from ...record.reader import Run, Snapshot
from ...scenario.kinematics import DEFORM
from .. import numbers as measure
from ..grading import is_structure


@dataclass(frozen=True)
class Grains:
    """The grains at one time, SI units; `id` stays with a grain."""

    id: np.ndarray  # (n,)
    position: np.ndarray  # (n, dim)
    velocity: np.ndarray  # (n, dim)
    spin: np.ndarray  # (n, 3) rad/s; nan where a grain is one particle
    contacts: np.ndarray  # (n,) number of bodies or grains it touches
    diameter: np.ndarray  # (n,)
    mass: np.ndarray  # (n,) kg, 2-D: kg/m
    is_part: np.ndarray  # (n,) bool: has come off another one

    @property
    def speed(self) -> np.ndarray:
        """|v| (n,), m/s."""
        return measure.speed(self.velocity)

    @property
    def volume(self) -> np.ndarray:
        """Of balls (discs in 2-D) of these diameters, (n,)."""
        dim = self.position.shape[1]
        return math.pi * self.diameter**dim / (4 if dim == 2 else 6)


@dataclass(frozen=True)
class Surroundings:
    """What is around the grains: water with its volume, fixed particles with their spacing."""

    water: np.ndarray  # (m, dim)
    water_volume: np.ndarray  # (m,)
    fixed: np.ndarray  # (k, dim)
    fixed_spacing: np.ndarray  # (k,)


def grains_of(snapshot: Snapshot, fluids: set[str], structures: set[str]) -> Grains:
    """The grains of a snapshot; those that have left the run are not among them.

    Nor are `structures`, see structure_names; what has come off one is a grain.
    """
    if table := snapshot.grains:
        kept = (table["removed"] == 0) & ~is_structure(snapshot, structures)
        t = {name: values[kept] for name, values in table.items()}
        return Grains(
            np.flatnonzero(kept), t["position"], t["velocity"], t["spin"], t["contacts"],
            t["diameter"], t["mass"], t["parent"] >= 0,
        )  # fmt: skip
    solid = (snapshot["motion"] == FREE) & ~np.isin(snapshot["material"], sorted(fluids))
    position, mass = snapshot["position"][solid], snapshot["mass"][solid]
    volume = mass / snapshot["density"][solid]
    diameter = np.sqrt(4 * volume / math.pi) if snapshot.dim == 2 else np.cbrt(6 * volume / math.pi)
    return Grains(
        snapshot["id"][solid], position, snapshot["velocity"][solid],
        np.full((len(mass), 3), np.nan), _near(position, diameter), diameter, mass,
        np.zeros(len(mass), bool),
    )  # fmt: skip


def keep_their_shape(run: Run, snapshot: Snapshot) -> np.ndarray:
    """Which rows (n,) of the table of bodies are rigid and as the scenario made them.

    The others bend, or have come off such as do.
    """
    tables = run.scenario.get("body", {})
    deform = {name for name, table in tables.items() if table.get("kinematics") in DEFORM}
    table = snapshot.grains
    if not table:
        return np.zeros(0, bool)
    return (table["parent"] < 0) & ~np.isin(table["body"], sorted(deform))


def _near(position: np.ndarray, diameter: np.ndarray) -> np.ndarray:
    """Number of grains whose centres are nearer than a diameter."""
    if not len(position):
        return np.zeros(0, int)
    return cKDTree(position).query_ball_point(position, diameter, return_length=True) - 1


def surroundings_of(snapshot: Snapshot, fluids: set[str]) -> Surroundings:
    """Water and fixed particles of a snapshot."""
    volume = snapshot["mass"] / snapshot["density"]
    water = (snapshot["motion"] == FREE) & np.isin(snapshot["material"], sorted(fluids))
    fixed = snapshot["motion"] == FIXED
    x = snapshot["position"]
    return Surroundings(x[water], volume[water], x[fixed], volume[fixed] ** (1 / snapshot.dim))
