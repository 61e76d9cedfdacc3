"""A body on a bed with water on one side and air on the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.validate.running import Running

DEPTH, DENSITY, GRAVITY, WIDTH = 0.4, 1000.0, 9.81, 0.2
THRUST = 0.5 * DENSITY * GRAVITY * DEPTH**2  # N/m
FULL = DENSITY * GRAVITY * DEPTH * WIDTH  # N/m, of the whole head under the body
HEAD = """
dim = 2
scheme = "resolved"
dp = {dp}
time_max = 1
time_out = 1
gravity = {gravity}
speed_max = 3

[contact]
speed = 3

[material.rock]
law = "solid"
rho0 = 2500
young_modulus = 1e8
poisson_ratio = 0.25
friction = 0
fracture = "cohesive"
tensile_strength = 1e7
fracture_energy = 1e5
"""
BOX = """
[body.{name}]
shape = "box"
material = "{material}"
min = {low}
max = {high}
rotate = {angle}
pivot = [0, 0]
{more}
"""
FIXED = 'fixed = true\nwall = "free_slip"'


def dam(dp: float, angle: float, side: int, gate: str, tail: float = 0.0) -> str:
    """A tank between a wall and a gate that leans on a stop; all turned by `angle`, degrees.

    The gate is on the right of the water, side = 1, or on its left, -1.
    """
    turn = np.radians(angle)
    up = np.array([-np.sin(turn), np.cos(turn)])
    tables = HEAD.format(dp=dp, gravity=(-GRAVITY * up).tolist())

    def box(name, x, y, more, material="rock"):
        nonlocal tables
        low, high = sorted((side * x[0], side * x[1]))
        tables += BOX.format(
            name=name, material=material, low=[low, y[0]], high=[high, y[1]], angle=angle, more=more
        )

    def pressure(depth):
        return f'pressure = "= {DENSITY * GRAVITY}*({depth} - ({up[0]}*x + {up[1]}*y))"'

    thick = 3 * dp
    box("floor", (-1 - thick, 1), (-thick, 0), FIXED + "\nnormal = [0, 1]")
    box("back", (-1 - thick, -1), (0, 0.6), FIXED + f"\nnormal = [{side}, 0]")
    box("water", (-1, 0), (0, DEPTH), pressure(DEPTH), "water")
    box("gate", (0, WIDTH), (0, 0.52), gate)
    box("stop", (WIDTH, WIDTH + 0.12), (0.12, 0.24), f"fixed = true\nnormal = [{-side}, 0]")
    if tail:
        box("tail", (WIDTH, 1), (0, tail), pressure(tail), "water")
        box("end", (1, 1 + thick), (0, 0.6), FIXED + f"\nnormal = [{-side}, 0]")
    return tables


@pytest.fixture
def forces(tmp_path: Path):
    """Mean force of the water on each body late in the run, N/m, along x and upwards."""

    def run(dp=0.04, angle=0.0, side=1, gate='kinematics = "rigid"', tail=0.0):
        path = tmp_path / "dam.toml"
        path.write_text(dam(dp, angle, side, gate, tail), encoding="utf-8")
        running, turn = Running(str(path)), np.radians(angle)
        axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        found = []
        for time in np.linspace(0.75, 1, 100):  # sound swings by a sixth of the thrust
            state = running.advance(time)
            found.append(
                [axes @ state["force"][state["body"] == k].sum(0)
                 for k in range(len(running.body_names))]
            )  # fmt: skip
        means = np.mean(found, axis=0) * [side, 1]
        return dict(zip(running.body_names, means, strict=True))

    return run


@pytest.mark.parametrize(("angle", "side"), [(0, 1), (0, -1), (20, 1)])
def test_water_presses_on_a_body_with_a_dry_side_as_on_a_wall(forces, angle, side):
    """Its pressure under the body falls to that of the air, and none of it acts on the dry side."""
    wall = forces(angle=angle, side=side, gate="fixed = true")["gate"][0]
    found = forces(angle=angle, side=side)
    assert wall == pytest.approx(THRUST, rel=0.05)
    assert found["gate"][0] == pytest.approx(wall, rel=0.02)
    assert abs(found["floor"][0]) < 0.01 * THRUST
    assert abs(found["stop"][0]) < 0.01 * THRUST
    assert found["gate"][1] == pytest.approx(0.5 * FULL, rel=0.12)


def test_it_converges_to_the_thrust_of_still_water(forces):
    found = forces(dp=0.02)
    assert found["gate"][0] == pytest.approx(THRUST, rel=0.03)
    assert found["gate"][1] == pytest.approx(0.5 * FULL, rel=0.06)


def test_what_may_break_has_the_same(forces):
    found = forces(dp=0.02, gate='kinematics = "breakable"')
    assert found["gate"][0] == pytest.approx(THRUST, rel=0.03)
    assert found["gate"][1] == pytest.approx(0.5 * FULL, rel=0.06)


def test_water_on_both_sides_bears_the_whole_of_it(forces):
    found = forces(dp=0.02, tail=DEPTH)
    assert abs(found["gate"][0]) < 0.05 * THRUST  # it swings a little
    assert found["gate"][1] == pytest.approx(FULL, rel=0.02)
