"""What to change after a failure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...scenario.model import Scenario
from ...scene.checks.particle_overlaps import Overlap
from ...util.finding import Finding
from ..sound_speed import raised

LARGE_COURANT = 0.3  # above this the scheme is not known to be stable
MACH = 0.3  # above this a reduced sound speed is too low


def remedy(report: dict[str, Any], scenario: Scenario, warnings: Sequence[Finding]) -> str:
    """One or two sentences: the parameters to change, with values, and why.

    `warnings` are those that came up when the scene was built.
    """
    if report["kind"] == "unresolved":
        return "Make dp smaller, or the body thicker where it is thinnest."
    if report["kind"] == "empty":
        return "Check the outflows: every particle has left or was removed."
    if "particle" not in report:
        return (
            "Lower cflnumber; where bodies meet faster or are pressed harder than they can bear,"
            " raise young_modulus or contact.speed."
        )
    said = (
        _bad_start(report),
        _overlap(report, warnings),
        _courant(scenario),
        _mach(report, scenario),
        _outside(report),
    )
    key, given = scenario.sound_speed_key
    return " ".join([each for each in said if each][:2]) or (
        f"Try half the timestep (--set cflnumber={scenario.cflnumber / 2:g} --set"
        f" cfl_force={scenario.cfl_force / 2:g}) with doseki resume; if it fails at the same"
        f" time, raise {key} (now {given:.4g}) or lower dp."
    )


def _bad_start(report: dict[str, Any]) -> str | None:
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


def _courant(scenario: Scenario) -> str | None:
    for name in ("cflnumber", "cfl_force"):
        value = getattr(scenario, name)
        if value > LARGE_COURANT:
            return f"Lower {name} from {value:g} to 0.1: the timestep is too long for stability."
    return None


def _overlap(report: dict[str, Any], warnings: Sequence[Finding]) -> str | None:
    """Bodies that overlapped at the start, the particle or a neighbour of it in one of them."""
    bodies = {report["particle"]["body"], *(n["body"] for n in report.get("neighbours", ()))}
    overlaps = (w for w in warnings if isinstance(w, Overlap))
    found = next((overlap for overlap in overlaps if {overlap.place, overlap.other} & bodies), None)
    return f"Move the bodies so that they do not overlap: {found}." if found else None


def _mach(report: dict[str, Any], scenario: Scenario) -> str | None:
    """Speeds that were given; those of a blow-up are its consequence."""
    particle, speed = report["particle"], report["initial_speed"]
    mach = speed / particle["sound_speed"] if particle["sound_speed"] > 0 else 0.0
    if not mach > MACH:
        return None
    return (
        f"Set {raised(*scenario.sound_speed_key, mach / 0.1)}, or lower the"
        f" velocities: {speed:.4g} m/s is Mach {mach:.2g} in {particle['material']}; the scheme"
        " is meant for 0.1."
    )


def _outside(report: dict[str, Any]) -> str | None:
    if report["kind"] != "outside":
        return None
    return "Add an outflow where particles leave, widen the domain, or close the gap in the walls."


def _number(value: float | None) -> float:
    return np.inf if value is None or not np.isfinite(value) else value
