"""A block with Coulomb's friction on the map of AvaFrame's avaSlide: 35 degrees, a bend, level."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from doseki.geodata.raster import read_raster

from .scenes import fluid, simulation_of

MAP = Path(__file__).resolve().parents[3] / "shared/data/terrain/avaSlide/Inputs/slideTopo.asc"
pytestmark = pytest.mark.skipif(not MAP.exists(), reason=f"no measured data: {MAP} is not there")

WEST, EAST, MIDDLE = 3.5, 2080.0, 500.0  # of the section on the map, m; it does not vary across
START, LENGTH, THICKNESS, MU = 150.0, 60.0, 4.0, 0.4
# Stiff enough to stay a block: half its height would stand by itself, and it creeps little.
SCENARIO = """
dim = 2
dp = 1.0
time_max = 60
time_out = 60
scheme = "resolved"
gravity = [0, -9.81]
speed_max = 60
[terrain]
file = "{file}"
section = {section}
material = "basalt"
wall = "voellmy"
mu = {mu}
[material.debris]
based_on = "water"
rheology = "herschel_bulkley"
yield_stress = 2e4
consistency = 100
regularisation = 170
viscosity_max = 3.4e6
[body.block]
shape = "release"
material = "debris"
between = {between}
thickness = 4.0
"""


class Profile:
    """The section of the map: slope and curvature at x from its upper end, m."""

    def __init__(self):
        self.x = np.arange(0.0, EAST - WEST, 1.0)
        height = read_raster(MAP).sampled(WEST + self.x, np.full_like(self.x, MIDDLE))
        self.slope = np.gradient(height, 1.0)
        # Heights are rounded to 1 cm: curvature is a mean over four cells.
        self.bend = np.convolve(np.gradient(self.slope, 1.0), np.full(21, 1 / 21), "same")

    def train(self, centre, length, mu, curved=True):
        """Rows (time, s; middle, m; speed, m/s) of masses along the profile, one every 3 m.

        Each has dv/dt = g sin t - mu (g cos t + v2 kappa), and all go with the mean of it.
        """
        g, dt = 9.81, 2e-3
        x, v, rows = centre + np.linspace(-0.5, 0.5, 21) * length, 0.0, []
        while len(rows) < 100 or v > 0.0:
            slope = np.interp(x, self.x, self.slope)
            cos = 1 / np.hypot(1, slope)
            bent = np.interp(x, self.x, self.bend) * cos**3 if curved else 0.0
            gain = -g * slope * cos - mu * (g * cos + v * v * bent)
            v = max(0.0, v + dt * float(gain.mean()))
            x = x + dt * v * cos
            rows.append((dt * (len(rows) + 1), float(x.mean()), v))
        return np.array(rows)


def slid(folder, time, mu, mirrored=False):
    """Rows (time; place from the upper end; speed; length) of the block, a second apart."""
    ends = [[WEST, MIDDLE], [EAST, MIDDLE]]
    low, high = START - 0.5 * LENGTH, START + 0.5 * LENGTH
    if mirrored:
        ends, low, high = ends[::-1], EAST - WEST - high, EAST - WEST - low
    path = folder / "case.toml"
    path.write_text(SCENARIO.format(file=MAP, section=ends, mu=mu, between=[low, high]))
    simulation, _ = simulation_of(path)
    rows = []
    while simulation.time < time and not (len(rows) > 3 and rows[-1][2] < 0.05):
        simulation.advance(limit=time, pause=simulation.time + 1.0, max_steps=10**7)
        state = simulation.state()
        own = fluid(state)
        x = state["position"][own][:, 0]
        x = EAST - WEST - x if mirrored else x
        speed = np.linalg.norm(state["velocity"][own].mean(axis=0))
        rows.append((simulation.time, x.mean(), speed, np.ptp(np.percentile(x, (2, 98)))))
    return np.array(rows)


CENTRE = START + 0.5 * THICKNESS * math.sin(math.atan(0.7))


@pytest.mark.validate
def test_its_speeds_are_those_of_the_closed_form(tmp_path):
    """Within 2 %: after 10 and 20 s on the slope, and the highest, in the bend."""
    rows = slid(tmp_path, 32.0, MU)
    exact = Profile().train(CENTRE, LENGTH, MU)
    for second in (10, 20):
        speed = np.interp(rows[second - 1, 0], exact[:, 0], exact[:, 2])
        assert rows[second - 1, 2] == pytest.approx(speed, rel=0.02)
    assert rows[:, 2].max() == pytest.approx(exact[:, 2].max(), rel=0.02)
    # The control: a closed form that knows nothing of the curvature of the bed.
    straight = Profile().train(CENTRE, LENGTH, MU, curved=False)
    assert straight[:, 2].max() > 1.04 * rows[:, 2].max()


@pytest.mark.validate
def test_mirrored_it_is_as_fast(tmp_path):
    """The section taken from its other end."""
    rows = slid(tmp_path, 6.0, MU, mirrored=True)
    exact = Profile().train(CENTRE, LENGTH, MU)
    speed = np.interp(rows[-1, 0], exact[:, 0], exact[:, 2])
    assert rows[-1, 2] == pytest.approx(speed, rel=0.02)


@pytest.mark.validate
def test_its_stop_is_that_of_the_closed_form(tmp_path):
    rows = slid(tmp_path, 60.0, MU)
    assert rows[-1, 2] < 0.05, "it has stopped"
    way = Profile().train(CENTRE, LENGTH, MU)[-1, 1] - CENTRE
    assert rows[-1, 1] - CENTRE == pytest.approx(way, rel=0.02)


@pytest.mark.minutes
def test_without_friction_it_is_too_fast(tmp_path):
    """The control, for three seconds."""
    rows = slid(tmp_path, 3.0, 0.0)
    slope = math.atan(0.7)
    assert rows[-1, 2] > 2 * 9.81 * (math.sin(slope) - MU * math.cos(slope)) * rows[-1, 0]
