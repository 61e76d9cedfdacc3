"""How hard a wall is hit is known of bodies that deform or break as it is of rigid ones."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

HIT = """
dim = 2
scheme = "resolved"
dp = 0.02
time_max = 0.004
time_out = 0.004
gravity = [0, 0]
speed_max = 8

[contact]
speed = 6

[material.soft]
law = "solid"
rho0 = 2400
young_modulus = 2e9
poisson_ratio = 0.2
friction = 0.4
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 100

[body.wall]
shape = "box"
material = "aluminium"
fixed = true
min = [2, -0.6]
max = [2.4, 1.6]

[body.boulder]
shape = "disc"
material = "soft"
centre = [1.845, 0.5]
radius = 0.15
velocity = [5, 0]

[gauge.wall]
kind = "load"
bodies = ["wall"]
interval = 0.0005
"""


@pytest.mark.parametrize("kinematics", ["rigid", "elastic", "breakable"])
def test_a_hit_is_by_the_body_as_it_came(tmp_path, kinematics):
    (tmp_path / "hit.toml").write_text(HIT)
    scenario = load_scenario(str(tmp_path / "hit.toml"), [f"body.boulder.kinematics={kinematics}"])
    run_scenario(scenario, tmp_path / "run", RunOptions(threads=1))
    record = load(tmp_path / "run").gauges["wall"]
    hardest = np.argmax(np.nan_to_num(record["hit_speed"] ** 1.2 * record["hit_radius"] ** 2))
    assert record["hit_speed"][hardest] == pytest.approx(5, rel=0.02)
    assert record["hit_radius"][hardest] == pytest.approx(0.15, rel=0.05)
