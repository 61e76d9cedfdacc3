"""A dam break of a mass with Coulomb's friction on an incline, against the analytic profile."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .scenes import fluid, profile, simulation_of, text

TILT, MU, DEPTH, LENGTH, TIME = math.radians(22), math.tan(math.radians(12)), 1.0, 14.0, 1.6
MASS = """
mu = {mu}
[material.debris]
based_on = "water"
rheology = "mu_i"
mu_s = 0.25
mu_2 = 0.26
inertial_number = 0.3
grain_diameter = 0.02
grain_density = 2650
viscosity_max = 3e4
[body.mass]
shape = "release"
material = "debris"
between = [{low}, 0.0]
thickness = {depth}
"""


def exact(x, time, mu):
    """Depth normal to the bed, m, at places x (N,) along it (Mangeney, Heinrich & Roche 2000).

    Ritter's dam break, in a frame that goes with the acceleration of the slab.
    """
    pull = 9.81 * math.cos(TILT)
    c = math.sqrt(pull * DEPTH)
    moved = x - 0.5 * 9.81 * (math.sin(TILT) - mu * math.cos(TILT)) * time**2
    wave = np.maximum(2 * c - moved / time, 0.0) ** 2 / (9 * pull)
    return np.where(moved < -c * time, DEPTH, wave)


# The wave as the solution has it after a time, its speed the same over the depth.
WAVE = """
[body.mass]
shape = "box"
material = "debris"
min = [{low}, 0.0]
max = [{high}, 1.0]
rotate = {turn}
pivot = [0, 0]
where = "= {depth} - {across}"
velocity = ["= {cos}*{sign}*{along} + {sin}*{sign}*{sinking}", "= -{sin}*{along} + {cos}*{sinking}"]
pressure = "= {weight}*max(0, {depth} - {across})"
"""


def wave(time, sign):
    """The mass as the solution has it at a time, as a table of a scenario."""
    cos, sin = math.cos(TILT), math.sin(TILT)
    pull = 9.81 * cos
    c, gain = math.sqrt(pull * DEPTH), 9.81 * (sin - MU * cos)
    gone = 0.5 * gain * time**2
    place, across = f"({sign}*x*{cos} - y*{sin})", f"({sign}*x*{sin} + y*{cos})"
    speed = f"min({2 * c}, max(-{c}, ({place} - {gone})/{time}))"
    ends = sorted((sign * (gone - LENGTH), sign * (gone + 2 * c * time)))
    return WAVE.format(
        low=ends[0], high=ends[1], turn=-sign * math.degrees(TILT), cos=cos, sin=sin, sign=sign,
        across=across, depth=f"((2*{c} - {speed})**2/{9 * pull})", weight=1000 * pull,
        along=f"({gain * time} + 2/3*({c} + {speed}))",
        # The wave becomes longer by 2/(3 t) of it a second, and so lower.
        sinking=f"(-{2 / (3 * time)}*{across}*min(1, 1e6*({speed} + {c})))",
    )  # fmt: skip


def depths(path, sign, time=TIME):
    """Middles of strips along the bed, m, and the depth in each after a time, s."""
    simulation, _ = simulation_of(path)
    simulation.advance(limit=time, pause=time, max_steps=10**7)
    state = simulation.state()
    own = fluid(state)
    position, volume = state["position"][own] * [sign, 1], (state["mass"] / state["density"])[own]
    along = position[:, 0] * math.cos(TILT) - position[:, 1] * math.sin(TILT)
    edges = np.arange(-6.0, 14.01, 0.5)
    area, _ = np.histogram(along, edges, weights=volume)
    return 0.5 * (edges[1:] + edges[:-1]), area / 0.5


@pytest.mark.minutes
@pytest.mark.parametrize("sign", [1, -1])
def test_the_profile_of_a_dam_break_on_an_incline(tmp_path, sign):
    ends = sorted((-sign * 20.0, sign * 20.0))
    profile(tmp_path / "terrain.csv", lambda x: -math.tan(TILT) * sign * x, *ends)
    path = tmp_path / "case.toml"
    more = MASS.format(mu=MU, low=-LENGTH, depth=DEPTH)
    if sign < 0:
        more = more.replace(f"[{-LENGTH}, 0.0]", f"[0.0, {LENGTH}]")
    path.write_text(text(2, dp=0.125, speed=12.0, wall="voellmy", more=more))
    x, depth = depths(path, sign)
    profile_now = exact(x, TIME, MU)
    off = np.abs(depth - profile_now).sum() / profile_now.sum()
    assert off < 0.09
    frictionless = exact(x, TIME, 0.0)
    assert np.abs(depth - frictionless).sum() / frictionless.sum() > 2 * off  # the control


@pytest.mark.validate
@pytest.mark.parametrize("sign", [1, -1])
def test_the_wave_goes_on_as_the_solution_does(tmp_path, sign):
    """At 12 over the depth, from half of the time on: without the column that it begins as."""
    ends = sorted((-sign * 20.0, sign * 30.0))
    profile(tmp_path / "terrain.csv", lambda x: -math.tan(TILT) * sign * x, *ends)
    path = tmp_path / "case.toml"
    mass = MASS[: MASS.index("[body.mass]")].format(mu=MU) + wave(0.5 * TIME, sign)
    path.write_text(text(2, dp=DEPTH / 12, speed=14.0, wall="voellmy", more=mass))
    x, depth = depths(path, sign, 0.5 * TIME)
    for mu, within in ((MU, True), (0.8 * MU, False)):  # the control: four fifths of the friction
        profile_now = exact(x, TIME, mu)
        assert (np.abs(depth - profile_now).sum() < 0.05 * profile_now.sum()) == within
