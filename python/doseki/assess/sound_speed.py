"""Advice on the reduced sound speed, in the key by which a scenario gives it."""

from __future__ import annotations

from ..record.reader import Run
from ..scenario.materials import Material
from ..scenario.model import Scenario
from ..util.finding import rounded_up

POWERS = {"xi": 1.0, "speed_max": 1.0, "xi_height": 2.0}  # of the sound speed that it goes with


def raised(key: str, value: float, factor: float) -> str:
    """What `key` = `value` must be for a sound speed `factor` times as high, and what it is now."""
    wanted = rounded_up(value * factor ** POWERS[key])
    return f"{key} = {wanted:g} (now {value:.3g})"


def sound_speed_from(run: Run) -> tuple[str, float]:
    """The key by which the scenario of a run gave its reduced sound speed, and its value."""
    given = run.summary.get("sound_speed_from") or {"xi": run.scenario.get("xi", 1.0)}
    key, value = next(iter(given.items()))
    return str(key), float(value)


def usual_speed(scenario: Scenario, fluid: Material) -> float:
    """Half of the speed that the sound speed is for, m/s: of most of a flow, not of its front."""
    return 0.05 * scenario.xi * fluid.speedsound
