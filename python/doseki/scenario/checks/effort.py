"""Whether a run could ever come to its end."""

from __future__ import annotations

import math

import numpy as np

from ...errors import UserError
from ..model import Scenario

# More would take weeks even for one particle.
MAX_STEPS = 1e12
SOFTEST = 1e-3  # of the speed that a particle gains as it falls by its own size
# With which a value is compared, to name the one that is to blame.
USUAL = {"time_max": 10.0, "sound speed": 100.0, "cflnumber": 0.1, "dp": 0.01}


def check_effort(scenario: Scenario) -> None:
    """Raise UserError where the timestep that sound allows makes more than MAX_STEPS steps."""
    sound = scenario.xi * scenario.min_sound_speed
    length = scenario.eta * min([scenario.dp, *_spacings(scenario)])
    if not math.isfinite(sound) or sound <= 0:
        steps = math.inf
    else:
        steps = scenario.time_max / (scenario.cflnumber * length) * sound
    if 0 < sound < (least := _least_sound(scenario)):
        raise _too_slow(scenario, sound, least)
    if steps <= MAX_STEPS:
        _check_contacts(scenario)
        return
    key, value = _to_blame(scenario, sound)
    raise scenario.where.error(
        (key,),
        f"{key} = {value:g} makes a run of {steps:.2g} steps (time_max = {scenario.time_max:g} s, "
        f"sound speed {sound:.3g} m/s, dp = {scenario.dp:g} m, cflnumber = "
        f"{scenario.cflnumber:g}); at most {MAX_STEPS:g} are taken",
    )


def _least_sound(scenario: Scenario) -> float:
    """The speed of sound, m/s, of a material that gives way to the weight of one particle."""
    return SOFTEST * math.sqrt(float(np.linalg.norm(scenario.gravity)) * scenario.dp)


def _too_slow(scenario: Scenario, sound: float, least: float) -> UserError:
    key = _sound_key(scenario)
    return scenario.where.error(
        (key,),
        f"{key} = {getattr(scenario, key):g} makes a speed of sound of {sound:.3g} m/s; at least "
        f"{least:.3g} is needed for the weight of one particle: raise it (speed_max is the fastest "
        "flow that you expect)",
    )


def contact_steps(scenario: Scenario, diameter: float, time: float) -> float:
    """Steps that contacts of bodies as large as `diameter`, m, take in `time`, s (docs: Eq. 52)."""
    contact = scenario.contact
    if contact.stiffness == "softened":
        speed = contact.speed or 0.1 * scenario.xi * scenario.min_sound_speed
        length = math.pi * contact.overlap * diameter
    else:
        speed, length = scenario.min_sound_speed, diameter
    return time * scenario.steps_of_contact * speed / length if length > 0 else math.inf


def _check_contacts(scenario: Scenario) -> None:
    """The same for contacts of bodies that move as a whole: the smallest take most steps."""
    diameters = {
        name: body.smallest
        for name, body in scenario.body.items()
        if name not in scenario.particle_tables
        and scenario.kinematics_of(name).is_whole
        and body.smallest is not None
    }
    if not diameters:
        return
    name, diameter = min(diameters.items(), key=lambda item: item[1])
    steps = contact_steps(scenario, diameter, scenario.time_max)
    if not steps <= MAX_STEPS:
        raise scenario.where.error(
            ("body", name),
            f"body.{name}: contacts of a body of {diameter:.3g} m make a run of {steps:.2g} "
            f"steps (contact.overlap = {scenario.contact.overlap:g}); at most {MAX_STEPS:g} "
            "are taken",
        )


def _spacings(scenario: Scenario) -> list[float]:
    """Those of bodies that have their own, m."""
    return [dp for body in scenario.body.values() if (dp := body.given("dp")) is not None]


def _to_blame(scenario: Scenario, sound: float) -> tuple[str, float]:
    """The key that differs most from what is usual, and its value."""
    ratios = {
        "time_max": scenario.time_max / USUAL["time_max"],
        "cflnumber": USUAL["cflnumber"] / scenario.cflnumber,
        "dp": USUAL["dp"] / scenario.dp,
        _sound_key(scenario): max(sound, 1e-300) / USUAL["sound speed"],
    }
    if not sound > 0:
        ratios[_sound_key(scenario)] = math.inf
    key = max(ratios, key=lambda name: ratios[name])
    return key, float(getattr(scenario, key))


def _sound_key(scenario: Scenario) -> str:
    """What the sound speed follows from."""
    given = ("speed_max", "xi_height")
    return next((key for key in given if getattr(scenario, key) is not None), "xi")
