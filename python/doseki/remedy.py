"""What to change after a failure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .scenario import Scenario

LARGE_COURANT = 0.3  # above this the scheme is not known to be stable
MACH = 0.3  # above this a reduced sound speed is too low


def remedy(report: dict[str, Any], scenario: Scenario) -> str:
    """One or two sentences: the parameters to change, with values, and why."""
    if "particle" not in report:
        return "Check the outflows: every particle has left or was removed."
    rules = (_bad_start, _overlap, _courant, _mach, _outside)
    found = [said for rule in rules if (said := rule(report, scenario))]
    return " ".join(found[:2]) or (
        f"Try half the timestep (--set cflnumber={scenario.cflnumber / 2:g} --set"
        f" cfl_force={scenario.cfl_force / 2:g}) with doseki resume; if it fails at the same"
        f" time, raise xi (now {scenario.xi:.4g}) or lower dp."
    )


def _bad_start(report: dict[str, Any], _scenario: Scenario) -> str | None:
    """A quantity that is absurd before anything could act on it was given so."""
    particle = report["particle"]
    if report["kind"] == "density" and report["step"] <= 1:
        return (
            f"Correct the density of body {particle['body']}: {particle['density']:.4g} kg/m3 is"
            f" not that of {particle['material']}."
        )
    if report["kind"] == "speed" and particle["speed"] > 0.5 * _number(report["became"]["speed"]):
        return (
            f"Lower the velocity of body {particle['body']}, {particle['speed']:.4g} m/s, or raise"
            " xi: it is faster than ten times any sound speed of the scenario."
        )
    return None


def _courant(_report: dict[str, Any], scenario: Scenario) -> str | None:
    for name in ("cflnumber", "cfl_force"):
        value = getattr(scenario, name)
        if value > LARGE_COURANT:
            return f"Lower {name} from {value:g} to 0.1: the timestep is too long for stability."
    return None


def _overlap(report: dict[str, Any], scenario: Scenario) -> str | None:
    """Bodies that overlapped at the start, as the scenario's warnings say."""
    bodies = {report["particle"]["body"], *(n["body"] for n in report.get("neighbours", ()))}
    warnings = [w for w in scenario.warnings if "overlaps" in w and w.split()[0] in bodies]
    if not warnings:
        return None
    return f"Move the bodies so that they do not overlap: {warnings[0]}."


def _mach(report: dict[str, Any], scenario: Scenario) -> str | None:
    """Speeds that were given; those of a blow-up are its consequence."""
    particle, speed = report["particle"], report["initial_speed"]
    mach = speed / particle["sound_speed"] if particle["sound_speed"] > 0 else 0.0
    if not mach > MACH:
        return None
    return (
        f"Raise xi from {scenario.xi:.4g} to {scenario.xi * mach / 0.1:.2g}, or lower the"
        f" velocities: {speed:.4g} m/s is Mach {mach:.2g} in {particle['material']}; the scheme"
        " is meant for 0.1."
    )


def _outside(report: dict[str, Any], _scenario: Scenario) -> str | None:
    if report["kind"] != "outside":
        return None
    return "Add an outflow where particles leave, widen the domain, or close the gap in the walls."


def _number(value: float | None) -> float:
    return np.inf if value is None or not np.isfinite(value) else value
