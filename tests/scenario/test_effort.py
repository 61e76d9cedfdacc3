"""What could never come to an end is refused before it begins, naming the key that is to blame."""

from __future__ import annotations

import pytest
from tests.small_scenarios import BLOCK

from doseki.errors import PhysicsError, UserError
from doseki.scenario.checks.effort import contact_steps
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

RESOLVED = 'scheme = "resolved"\nspeed_max = 2\ngravity = [0, -9.8]'
GRAINS = """
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.2, -0.03]
max = [0.6, 0]

[body.grains]
shape = "disc"
material = "basalt"
min = [0, 0]
max = [0.3, 0.3]
d = 0.02
count = 60
"""


@pytest.mark.parametrize(
    "setting",
    ["cflnumber=1e-308", "xi=1e26", "xi=1e308", "time_max=1e12 time_out=1e9"],
)
def test_endless_runs_name_their_key(write, error_of, setting):
    text = error_of(write(), *setting.split())
    assert f"{setting.split('=')[0]} = " in text
    assert "at most 1e+12 are taken" in text


def test_an_endless_speed_is_that_of_the_user(write, error_of):
    text = error_of(write(top=RESOLVED), "speed_max=1e300")
    assert "speed_max = 1e+300" in text


@pytest.mark.parametrize("speed", ["1e-300", "1e-310", "2e-5"])
def test_a_speed_that_nothing_has_is_refused(write, error_of, speed):
    text = error_of(write(top=RESOLVED), f"speed_max={speed}")
    assert f"speed_max = {float(speed):g} makes" in text
    assert "raise it (speed_max is the fastest flow" in text


def test_slow_flows_are_allowed(write):
    load_scenario(write(top=RESOLVED), ["speed_max=1e-3"])
    load_scenario(write(top=RESOLVED), ["speed_max=2e-5", "gravity=[0, -1e-6]"])


def test_what_takes_long_but_ends_is_allowed(write):
    load_scenario(write(tables=BLOCK), ["cflnumber=1e-6"])


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ("packing=0.92", "no arrangement fills more than 0.91"),
        ("count=1000", "no arrangement fills more than 0.91"),
        ("d=1e-12", "contacts of a body of 1e-12 m"),
        ("mass_total=1e12", "no arrangement fills more than 0.91"),
    ],
)
def test_impossible_packings(write, error_of, change, part):
    assert part in error_of(write(top=RESOLVED, tables=GRAINS), "dp=0.01", f"body.grains.{change}")


def test_spheres_fill_less(write, error_of):
    tables = GRAINS.replace('"disc"', '"sphere"').replace("0.3]", "0.3, 0.3]")
    tables = tables.replace("[0, 0]", "[0, 0, 0]").replace("[-0.2, -0.03]", "[0, 0, -0.03]")
    tables = tables.replace("[0.6, 0]", "[0.3, 0.3, 0]").replace("count = 60", "packing = 0.75")
    text = error_of(
        write(top=RESOLVED.replace("-9.8", "0, -9.8"), tables=tables), "dim=3", "dp=0.01"
    )
    assert "no arrangement fills more than 0.74" in text


@pytest.mark.parametrize("top", [("9.8", "1e-9"), ("speed_max = 2", "speed_max = 1e6")])
def test_settling_that_would_not_end(write, top):
    tables = GRAINS + "settle = true\n"
    with pytest.raises(UserError, match=r"settle: .* of settling would take .* steps"):
        filled_simulation(
            load_scenario(write(top=RESOLVED.replace(*top), tables=tables), ["dp=0.01"])
        )


def test_settling_in_which_physics_fails(write):
    top, tables = RESOLVED.replace("9.8", "1e9"), GRAINS + "settle = true\n"
    with pytest.raises(PhysicsError, match=r"body\.grains: settling fails"):
        filled_simulation(load_scenario(write(top=top, tables=tables), ["dp=0.01"]))


def test_contacts_take_longer_the_smaller_a_body_is(write):
    scenario = load_scenario(write(top=RESOLVED, tables=GRAINS))
    few, many = (contact_steps(scenario, d, 1.0) for d in (1e-2, 1e-3))
    assert many == pytest.approx(10 * few)
