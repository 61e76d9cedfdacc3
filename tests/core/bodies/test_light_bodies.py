"""Light bodies of few particles in water, which is stiff for them."""

from __future__ import annotations

import pytest

from doseki.assess.trust.ledger import ledger_of
from doseki.scenario.load import load_scenario
from doseki.validate.running import Running

from ...assess.accounts import gap, recorded

TEXT = """
schema = 1
dim = {dim}
scheme = "resolved"
gravity = {gravity}
dp = 0.04
time_max = 0.1
time_out = 0.1
speed_max = 4

[material.foam]
based_on = "basalt"
rho0 = {density}

[body.water]
shape = "box"
material = "water"
min = {low}
max = {high}
pressure = "= 9810*(0.4 - {up})"

[body.tank]
shape = "tank"
material = "aluminium"
fixed = true
wall = "free_slip"
min = {low}
max = {high}

[body.ball]
shape = "{ball}"
material = "foam"
centre = {centre}
radius = {radius}
"""


def scenario_text(dim=2, density=100.0, radius=0.1):
    """A ball at rest in the middle of water at rest."""
    rest = [0.0] * (dim - 1)
    return TEXT.format(
        dim=dim, gravity=[*rest, -9.81], density=density, radius=radius,
        low=[-0.4] * dim, high=[0.4] * dim, centre=[*rest, 0.0], up="xyz"[dim - 1],
        ball="disc" if dim == 2 else "sphere",
    )  # fmt: skip


@pytest.fixture
def write(tmp_path):
    def make(**values):
        path = tmp_path / "case.toml"
        path.write_text(scenario_text(**values), encoding="utf-8")
        return str(path)

    return make


@pytest.mark.parametrize(
    ("density", "radius", "expected"),
    [(100, 0.1, 0.2), (50, 0.2, 0.2), (600, 0.1, 0.8), (100, 0.3, 0.6), (100, 0.4, 0.8)],
)
def test_the_step_follows_from_density_and_size(write, density, radius, expected):
    scenario = load_scenario(write(density=density, radius=radius))
    assert scenario.cflnumber == pytest.approx(expected)
    assert bool(scenario.findings) == (expected < 0.8)


def test_a_shorter_step_that_was_asked_for_stays(write):
    scenario = load_scenario(write(), ["cflnumber=0.2"])
    assert scenario.cflnumber == 0.2
    assert not scenario.findings


@pytest.mark.parametrize("dim", [2, 3])
def test_a_light_ball_rises_as_with_short_steps(write, dim):
    """At the step that is the default for others it was thrown about, down first."""
    speeds = []
    for settings in ((), ("cflnumber=0.12",)):
        run = Running(write(dim=dim), *settings)
        speeds.append([])
        for time in (0.01, 0.02, 0.03, 0.04):
            run.advance(time)
            speeds[-1].append(float(run.grains()["velocity"][0, -1]))
    assert speeds[0] == pytest.approx(speeds[1], rel=0.15)
    assert speeds[0] == sorted(speeds[0])


BED = """
schema = 1
dim = 2
scheme = "resolved"
gravity = {gravity}
dp = 0.0125
time_max = 0.3
time_out = 0.3
speed_max = 2.5

[material.foam]
based_on = "basalt"
rho0 = 100
"""

BOX = """
[body.{name}]
shape = "box"
material = "{material}"
min = {low}
max = {high}
"""


def bed_text(axis):
    """A box of foam, 8 across, on the bed of a tank of water in which `axis` is up."""

    def place(along, up):
        return [along, up] if axis == 1 else [up, along]

    def box(name, material, low, high):
        return BOX.format(name=name, material=material, low=place(*low), high=place(*high))

    wall = 'fixed = true\nwall = "free_slip"\n'
    return (
        BED.format(gravity=place(0.0, -9.81))
        + box("bed", "aluminium", (-0.35, -0.05), (0.35, 0.0)) + wall
        + box("left", "aluminium", (-0.35, 0.0), (-0.3, 0.5)) + wall
        + box("right", "aluminium", (0.3, 0.0), (0.35, 0.5)) + wall
        + box("water", "water", (-0.3, 0.0), (0.3, 0.3))
        + f'pressure = "= 9810*(0.3 - {"xy"[axis]})"\n'
        + box("box", "foam", (-0.05, 0.0), (0.05, 0.1))
    )  # fmt: skip


@pytest.mark.parametrize("axis", [0, 1])
def test_a_light_box_on_a_bed_makes_no_energy(tmp_path, axis):
    assert gap(ledger_of(recorded(tmp_path, bed_text(axis)))) < 0.03


def test_with_longer_steps_it_does(tmp_path, monkeypatch):
    monkeypatch.setattr("doseki.scenario.checks.light_bodies._limits", lambda *_: [])
    assert gap(ledger_of(recorded(tmp_path, bed_text(1)))) > 0.3
