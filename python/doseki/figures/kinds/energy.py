"""The energies of a run over time, the potential energy and their sum among them."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ...record.history import BODY_ENERGIES
from ...record.reader import History, Run
from ...record.units import unit_in
from ...scenario.schemes import RESOLVED
from ..layout import chart_grid, figure_legend
from ..nothing import NothingToDrawError
from .series import draw_curves

ENERGIES = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")
GRAVITY, TAKEN = "gravity_work", "energy_left"
GIVEN = ("wall_work", "contact_work", "scheme_work", "energy_entered")
PASSED = ("mass_entered", "mass_left")


def draw_energy(run: Run) -> Figure:
    """Energies of the history with the potential energy, and their total where it is a balance.

    Where the run keeps an account of works, the total has what was given taken off and what was
    taken added, so that it stays what it was at the start; the potential energy is that of the
    start less the work of gravity, in which what leaves counts as it left.  Without an account
    there is no total where mass comes or goes.

    Raises NothingToDrawError for a history without energies.
    """
    if not set(ENERGIES) <= set(run.history):
        raise NothingToDrawError("the history has no energies")
    figure, grid = chart_grid(1, 1, (7.0, 3.2), "Energy")
    axes, history = grid[0, 0], run.history
    potential = potential_energy(run)
    accounted = _has_account(run) and potential.size > 0
    if accounted:
        times, curves = history["time"], _accounted(history, potential[0])
    else:
        times, curves = run.times, _recorded(run, potential)
    draw_curves(axes, times, curves)
    if accounted or not _is_open(history):
        total = sum(curves.values(), np.zeros(len(times)))
        axes.plot(times, total, "k-", label="total", linewidth=2.0, alpha=0.6)
    axes.set(xlabel="time (s)", ylabel=f"energy ({unit_in('J', run.scenario['dim'])})")
    figure_legend(figure, grid.flat)
    return figure


def _has_account(run: Run) -> bool:
    """Whether all that its particles got and lost is in the history."""
    resolved = run.scenario.get("scheme") == RESOLVED and not run.scenario.get("attraction")
    return resolved and GRAVITY in run.history


def _accounted(history: History, potential: float) -> dict[str, np.ndarray]:
    """What is there or was taken, less what was given; `potential` is that at the start, J."""
    since = history[GRAVITY] - history[GRAVITY][0]
    curves = {"potential energy": potential - since} if potential or since.any() else {}
    for name in (*ENERGIES, *BODY_ENERGIES, TAKEN, *GIVEN):
        values = history[name] if name in history else np.zeros(0)
        if values.any():
            said = name.replace("_", " ")
            curves[f"less {said}" if name in GIVEN else said] = -values if name in GIVEN else values
    return curves


def _recorded(run: Run, potential: np.ndarray) -> dict[str, np.ndarray]:
    """What is there, at the times of the snapshots."""
    history = run.history
    names = [name for name in (*ENERGIES, *BODY_ENERGIES) if name in history]
    found = {
        name.replace("_", " "): np.interp(run.times, history["time"], history[name])
        for name in names
        if history[name].any()
    }
    return found | ({"potential energy": potential} if potential.any() else {})


def _is_open(history: History) -> bool:
    """Whether mass has come or gone."""
    return any(history[name].any() for name in PASSED if name in history)


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
