"""Grading curves: how much of the mass of all bodies that move is finer than a size.

Structures, which are clamped, are none of them, but what has come off one is.  The size of a body
is the diameter of the ball (2-D: disc) of the volume of its particles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..record.reader import Run, Snapshot


@dataclass(frozen=True)
class Grading:
    """The bodies of a snapshot by size, the finest first."""

    grain: np.ndarray  # (n,) rows of the table of bodies
    size: np.ndarray  # (n,) m
    mass: np.ndarray  # (n,) kg; 2-D: kg/m
    finer: np.ndarray  # (n,) share of the mass of bodies of this size and finer ones


def structure_names(run: Run) -> set[str]:
    """The bodies of a scenario that are clamped."""
    tables = run.scenario.get("body", {})
    return {name for name, table in tables.items() if table.get("clamped") is not None}


def is_structure(snapshot: Snapshot, structures: set[str]) -> np.ndarray:
    """Which rows (n,) of the table of bodies are what is left of these bodies."""
    table = snapshot.grains
    if not table:
        return np.zeros(0, bool)
    return np.isin(table["body"], sorted(structures)) & (table["parent"] < 0)


def grading_of(snapshot: Snapshot, structures: set[str]) -> Grading:
    """Of the particles in the snapshot that are of bodies that move, but of `structures`."""
    own = (snapshot["grain"] >= 0) & ~np.isin(
        snapshot["grain"], np.flatnonzero(is_structure(snapshot, structures))
    )
    grain, index = np.unique(snapshot["grain"][own], return_inverse=True)
    mass = np.bincount(index, snapshot["mass"][own], len(grain))
    volume = np.bincount(index, (snapshot["mass"] / snapshot["density"])[own], len(grain))
    size = np.sqrt(4 * volume / math.pi) if snapshot.dim == 2 else np.cbrt(6 * volume / math.pi)
    order = np.argsort(size, kind="stable")
    cumulative = np.cumsum(mass[order])
    share = cumulative / cumulative[-1] if len(cumulative) else cumulative
    return Grading(grain[order], size[order], mass[order], share)


def has_parts(run: Run) -> bool:
    """Whether a body has come off another one by the end."""
    return len(run) > 0 and bool(np.any(run[-1].grains.get("parent", np.zeros(0)) >= 0))


def gradings(run: Run) -> dict[float, Grading]:
    """By time, s."""
    structures = structure_names(run)
    return {float(time): grading_of(run.at(time), structures) for time in np.unique(run.times)}


def grading_table(run: Run) -> dict[str, np.ndarray]:
    """One row for each body and time, the finest first; `parent` is -1 of those of the start."""
    parts: dict[str, list[np.ndarray]] = {}
    for time, grading in gradings(run).items():
        table = run.at(time).grains
        columns = {"time": np.full(len(grading.grain), time)} | vars(grading)
        columns |= {key: table[key][grading.grain] for key in ("parent", "born")}
        for key, values in columns.items():
            parts.setdefault(key, []).append(values)
    return {key: np.concatenate(values) for key, values in parts.items()}
