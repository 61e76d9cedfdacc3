"""Viscous liquids have no viscosity of the Riemann solver, and steps that bear theirs."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation
from doseki.validate.estimators import wave_amplitude
from doseki.validate.running import Running

VISCOSITY = 0.01  # m2/s, of a wave of 1 m and 1 m/s
ALONG_X = 'body.water.velocity=["= sin(2*pi*y/length)", 0]'
ALONG_Y = 'body.water.velocity=[0, "= -sin(2*pi*x/length)"]'


def fitted_viscosity(speed_max: float, velocity: str = ALONG_X, factor: float = 1.0) -> float:
    """Over VISCOSITY, from a shear wave of 12 particles in a liquid of `factor` times that."""
    run = Running(
        "shear-decay", "particles=12", f"material.water.nu={factor * VISCOSITY}",
        f"speed_max={speed_max:g}", velocity,
    )  # fmt: skip
    component = 0 if velocity == ALONG_X else 1
    rate = VISCOSITY * (2 * np.pi) ** 2
    times = np.linspace(0.25, 1, 9) / rate
    waves = [
        abs(wave_amplitude(state, component, 1 - component, 2 * np.pi))
        for state in run.sampled(times)
    ]
    return float(-np.polyfit(times, np.log(waves), 1)[0] / rate)


@pytest.mark.parametrize("velocity", [ALONG_X, ALONG_Y], ids=["along x", "along y, mirrored"])
def test_viscosity_does_not_follow_the_sound_speed(velocity):
    slow, fast = (fitted_viscosity(speed, velocity) for speed in (1, 10))
    assert slow == pytest.approx(1, abs=0.06)
    assert fast == pytest.approx(1, abs=0.06)  # 1.53 with all of the least beta


def test_a_fifth_more_viscosity_shows():
    assert fitted_viscosity(10, factor=1.2) == pytest.approx(1.2, abs=0.06)


TWO = """
dim = {dim}
scheme = "resolved"
speed_max = 1
dp = 0.1
time_max = 2
time_out = 2
gravity = {nowhere}

[material.water]
nu = 10
"""
PARTICLE = """
[body.{name}]
shape = "box"
material = "water"
min = {low}
max = {high}
velocity = {velocity}
"""


def energies(folder, text, steps):
    """Kinetic energy of a scenario after each of its first steps."""
    path = folder / "case.toml"
    path.write_text(text)
    simulation, _ = build_simulation(load_scenario(path))
    found = []
    for _ in range(steps):
        simulation.advance(limit=np.inf, pause=np.inf, max_steps=1)
        found.append(simulation.totals()["kinetic_energy"])
    return found


@pytest.mark.parametrize("angle", [0.0, 0.5])
@pytest.mark.parametrize("apart", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_two_particles_of_a_viscous_liquid_come_to_rest(core, tmp_path, dim, apart, angle):
    """They damp each other twice as fast as either, which no particle inside a liquid does.

    With steps for the inside their energy was 69 times as large after 20 of them.
    """
    along, across = np.zeros((2, dim))
    along[:2] = np.cos(angle), np.sin(angle)
    across[:2] = -np.sin(angle), np.cos(angle)
    text = TWO.format(dim=dim, nowhere=[0.0] * dim)
    for name, side in (("one", -1), ("two", 1)):
        centre, velocity = side * 0.05 * apart * along, side * 0.01 * across
        corners = (centre - 0.05).tolist(), (centre + 0.05).tolist()
        text += PARTICLE.format(
            name=name, low=corners[0], high=corners[1], velocity=velocity.tolist()
        )
    energy = energies(tmp_path, text, steps=20)
    assert energy[-1] < 1e-3 * energy[0]


BALL = """
[body.liquid]
shape = "box"
material = "water"
min = {nowhere}
max = {side}

[material.wood]
based_on = "basalt"
rho0 = {density}

[body.ball]
shape = "{shape}"
material = "wood"
centre = {middle}
radius = {radius}
velocity = {velocity}
spin = {spin}
"""


@pytest.mark.parametrize(
    ("dim", "across", "density"),
    [(2, 3, 300), (2, 8, 100), (2, 4, 3000), (3, 3, 300), (3, 4, 100)],
)
def test_a_light_ball_in_a_thick_liquid_comes_to_rest(core, tmp_path, dim, across, density):
    """It gains what the liquid loses: with steps for the liquid alone it was thrown out."""
    side = 1.6 if dim == 2 else 1.0
    values = {
        "nowhere": [0.0] * dim,
        "side": [side] * dim,
        "density": density,
        "shape": "disc" if dim == 2 else "sphere",
        "middle": [side / 2 + 0.003] * dim,
        "radius": 0.05 * across,
        "velocity": [0.01, 0.02, 0.03][:dim],
        "spin": 0.3 if dim == 2 else [0.3, 0.1, 0.2],
    }
    axes = ", ".join(f'"{axis}"' for axis in "xyz"[:dim])
    periodic = f"periodic = [{axes}]\ndomain_min = {[0.0] * dim}\ndomain_max = {[side] * dim}\n"
    text = TWO.replace("[material", periodic + "[material") + BALL
    energy = energies(tmp_path, text.format(dim=dim, **values), steps=120)
    assert max(energy[1:]) < 1.001 * energy[0]
    assert energy[-1] < 0.2 * energy[0]
