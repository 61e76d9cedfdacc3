"""`doseki trust SCENARIO --vary xi`: how much a run depends on the sound speed that was chosen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UserError
from ..measure.flow import measure_flow
from ..measure.numbers import mean_velocity, speed
from ..record.beginning import check_vacant
from ..record.particles import BOUND, FREE
from ..record.reader import Run, Snapshot, load
from ..record.units import unit_in
from ..running.runner import RunOptions
from ..scenario.load import load_scenario
from ..scenario.model import Scenario
from .in_turn import run_in_turn

FACTORS = {"half": 0.5, "base": 1.0, "double": 2.0}  # folder of each run, and what xi is times
NEGLIGIBLE = 1e-9  # of its scale: rounding
VARIABLE = ("xi",)

Measured = dict[str, tuple[float, str, float]]  # by name: value, unit, what to compare it with


@dataclass(frozen=True)
class Movement:
    """A summary quantity at half, given and double xi; `moved_percent` is of `scale`."""

    name: str
    unit: str
    values: list[float]
    scale: float
    moved_percent: list[float]  # at half and at double


def vary(
    name: str, settings: Sequence[str], key: str, directory: Path, threads: int | None
) -> dict[str, Any]:
    """Run a scenario at half, given and double `key`, in folders inside `directory`.

    Raises Interrupted where one of them is stopped.
    """
    if key not in VARIABLE:
        raise UserError(f"--vary {key}: only {', '.join(VARIABLE)} can be varied")
    scenarios = _scenarios(name, settings)
    check_vacant(directory)
    folders = {directory / part: scenario for part, scenario in scenarios.items()}
    run_in_turn(folders, RunOptions(threads))
    runs = [load(folder) for folder in folders]
    return {
        "vary": key,
        "values": [scenario.xi for scenario in scenarios.values()],
        "directories": [str(run.directory) for run in runs],
        "verdicts": [run.trust["verdict"] for run in runs],
        "quantities": [asdict(entry) for entry in movements([measured(run) for run in runs])],
    }


def _scenarios(name: str, settings: Sequence[str]) -> dict[str, Scenario]:
    """The scenario at each xi, all checked before the first one runs.

    Where xi follows from xi_height or speed_max these stay, for expressions may use them.
    """
    given = load_scenario(name, settings)
    if given.xi_height is None and given.speed_max is None:
        changed = {part: f"xi={given.xi * factor!r}" for part, factor in FACTORS.items()}
        return {part: load_scenario(name, [*settings, text]) for part, text in changed.items()}
    return {part: given.with_xi(given.xi * factor) for part, factor in FACTORS.items()}


def measured(run: Run) -> Measured:
    """The quantities that a run is summed up by, at its end."""
    history = {column: values[-1] for column, values in run.history.items()}
    energies = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")
    energy = sum(history[name] for name in energies)
    dim = run.scenario["dim"]
    found: Measured = {name: (history[name], unit_in("J", dim), energy) for name in energies}
    momentum = math.sqrt(2 * history["mass"] * history["kinetic_energy"])
    for axis in "xyz"[:dim]:
        own = history[f"momentum_{axis}"]
        found[f"momentum_{axis}"] = (own, unit_in("kg m/s", dim), momentum)
    mass = history["mass_initial"] + history["mass_entered"]
    found["mass_left"] = (history["mass_left"], unit_in("kg", dim), mass)
    return found | _of_materials(run) | _of_flow(run)


def _of_materials(run: Run) -> Measured:
    """Speeds of each material's free particles, and how far their centre of mass has moved."""
    first, last = run[0], run[-1]
    found: Measured = {}
    for name in last.material_names:
        free = _free(last, name)
        if not free.any():
            continue
        speeds = speed(last["velocity"][free])
        found[f"{name}: mean speed"] = (own := float(speeds.mean()), "m/s", own)
        found[f"{name}: highest speed"] = (own := float(speeds.max()), "m/s", own)
        if _free(first, name).any():
            moved = _centre(last, name) - _centre(first, name)
            distance = float(np.linalg.norm(moved))
            for axis, along in zip("xyz", moved, strict=False):
                found[f"{name}: centre moved along {axis}"] = (float(along), "m", distance)
    return found


def _free(snapshot: Snapshot, material: str) -> np.ndarray:
    return (snapshot["material"] == material) & np.isin(snapshot["motion"], (FREE, BOUND))


def _centre(snapshot: Snapshot, material: str) -> np.ndarray:
    free = _free(snapshot, material)
    return mean_velocity(snapshot["position"][free], snapshot["mass"][free])


def _of_flow(run: Run) -> Measured:
    """The way of the front, and the arrival of fluid in each window."""
    flow = measure_flow(run)
    if flow is None:
        return {}
    there = flow.front[np.isfinite(flow.front)]
    way = float(there[-1] - there[0])
    found: Measured = {"front moved": (way, "m", abs(way))}
    for name, entry in flow.windows.items():
        arrival = entry.arrival(flow.times)
        found[f"window {name}: arrival"] = (arrival, "s", arrival)
        passed = entry.passed_mass[-1]
        found[f"window {name}: grains passed"] = (
            passed,
            unit_in("kg", run.scenario["dim"]),
            passed,
        )
    return found


def movements(runs: Sequence[Measured]) -> list[Movement]:
    """How each quantity of the middle run differs in the others, in percent of its scale.

    What is nothing but rounding in all of them is left out.
    """
    half, base, double = runs
    found = []
    for name, (value, unit, scale) in base.items():
        values = [run.get(name, (math.nan,))[0] for run in (half, base, double)]
        if all(abs(v) <= NEGLIGIBLE * abs(scale) for v in values):
            continue
        moved = [_percent(values[k] - value, abs(scale)) for k in (0, 2)]
        found.append(Movement(name, unit, values, abs(scale), moved))
    return found


def _percent(change: float, scale: float) -> float:
    return 100 * change / scale if scale > 0 else (0.0 if change == 0 else math.nan)


def vary_text(report: dict[str, Any]) -> str:
    """The report as a table, with what moved most below it."""
    values = [f"xi = {xi:.4g}" for xi in report["values"]]
    lines = [_row("", "", values, ["half, %", "double, %"])]
    for entry in report["quantities"]:
        moved = [_signed(percent) for percent in entry["moved_percent"]]
        lines.append(_row(entry["name"], entry["unit"], map(_number, entry["values"]), moved))
    lines.append(_row("trust", "", report["verdicts"], ["", ""]))
    lines += ["", "Energies in percent of their sum, momenta of sqrt(2 m E_kinetic), ways of the"]
    lines += ["distance moved, all else of its own value at the given xi.", _most(report)]
    return "\n".join(lines)


def _row(name: str, unit: str, values: Any, moved: Sequence[str]) -> str:
    cells = "".join(f"{value:>14}" for value in values)
    return f"{name:<34}{unit:<8}{cells}" + "".join(f"{text:>11}" for text in moved)


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.5g}"


def _signed(percent: float) -> str:
    return "-" if math.isnan(percent) else f"{percent:+.2f}"


def _most(report: dict[str, Any]) -> str:
    most = max(report["quantities"], key=_farthest, default=None)
    if most is None:
        return "Nothing moved."
    return f"Moved most: {most['name']}, {_farthest(most):.3g} %."


def _farthest(entry: dict[str, Any]) -> float:
    return max((abs(p) for p in entry["moved_percent"] if not math.isnan(p)), default=0.0)
