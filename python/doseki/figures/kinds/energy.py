"""The energies of a run over time, the potential energy and their sum among them."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ...record.history import BODY_ENERGIES
from ...record.reader import Run
from ...record.units import unit_in
from ..layout import chart_grid, figure_legend
from ..nothing import NothingToDrawError
from .series import draw_curves

ENERGIES = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")


def draw_energy(run: Run) -> Figure:
    """Energies of the history; potential energy and total at the times of the snapshots.

    Raises NothingToDrawError for a history without energies.
    """
    if not set(ENERGIES) <= set(run.history):
        raise NothingToDrawError("the history has no energies")
    figure, grid = chart_grid(1, 1, (7.0, 3.2), "Energy")
    axes, history = grid[0, 0], run.history
    names = [*ENERGIES, *(name for name in BODY_ENERGIES if name in history)]
    stored = {name: history[name] for name in names if history[name].any()}
    draw_curves(axes, history["time"], {name.replace("_", " "): e for name, e in stored.items()})
    potential = potential_energy(run)
    known = [np.interp(run.times, history["time"], energy) for energy in stored.values()]
    of_snapshots = {"potential energy": potential} if potential.any() else {}
    draw_curves(axes, run.times, of_snapshots)
    axes.plot(run.times, sum(known, potential), "k-", label="total", linewidth=2.0, alpha=0.6)
    axes.set(xlabel="time (s)", ylabel=f"energy ({unit_in('J', run.scenario['dim'])})")
    figure_legend(figure, grid.flat)
    return figure


def potential_energy(run: Run) -> np.ndarray:
    """Of what moves, at the time of each snapshot (T,), J (2-D: J/m).

    Counted from the lowest place where anything has moved.
    """
    gravity = np.array(run.scenario.get("gravity", [0.0] * run.scenario["dim"]), dtype=float)
    sums, lowest = [], np.inf
    for snapshot in run:
        moves = ~snapshot["fixed"]
        mass, height = snapshot["mass"][moves], -snapshot["position"][moves] @ gravity
        sums.append((mass @ height, mass.sum()))
        lowest = min(lowest, height.min(initial=np.inf))
    energy, mass = np.array(sums).T
    return energy - mass * lowest if np.isfinite(lowest) else energy
