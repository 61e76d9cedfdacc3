"""A hydrograph into a channel of a map: what of its section lies above the ground carries it."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.estimates import mach_number
from doseki.assess.preflight import check_scenario
from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.checks.terrain import terrain_findings
from doseki.scene.inflow_sections import build_inflows, surge_volumes, to_enter
from doseki.solver.build import filled_simulation

from .scenes import fluid, grid, profile, text

INFLOW = """
[inflow.flood]
material = "water"
hydrograph = [[0, 0.2], [0.5, 0.5], [2, 0.5]]
position = [1.0, 0.5, 1.2]
direction = [1, 0, -0.2]
width = 3.0
depth = 1.2
"""


def channel(x, y):
    """A V-shaped channel that falls by 0.2 along x."""
    return 2 - 0.2 * x + 0.5 * np.abs(y - 2)


@pytest.fixture
def path(tmp_path):
    grid(tmp_path / "terrain.asc", channel)
    file = tmp_path / "case.toml"
    file.write_text(text(3, dp=0.1, time=1.0, speed=5.0, more=INFLOW))
    return file


def test_the_section_is_cut_by_the_channel(path):
    (section,) = build_inflows(load_scenario(path), ["terrain", "flood"])
    height = section.rows[:, 2] - channel(*section.rows[:, :2].T)
    assert height.min() > 0.04
    steep = np.sqrt(1 + 0.2**2 + 0.5**2)
    assert height.min() < 1.5 * 0.1 * steep
    area = len(section.rows) * 0.01
    assert section.speeds.max() == pytest.approx(0.5 / area)
    _, _, warnings = filled_simulation(load_scenario(path))
    (said,) = [str(each) for each in warnings if each.place == "inflow.flood"]
    assert f"{len(section.rows)} of 360 particles of a layer lie above the ground" in said


def test_the_largest_speed_is_that_through_what_the_channel_leaves(path):
    squares = []
    for factor in (10, 20):
        rows = f"inflow.flood.hydrograph=[[0, 0.2], [0.5, {factor}], [2, {factor}]]"
        scenario = load_scenario(path, [rows])
        simulation, names, _ = filled_simulation(scenario)
        section = build_inflows(scenario, names)[0]
        squares.append((mach_number(scenario, simulation.state())[0] ** 2, section.speed**2))
    expected, entering = np.diff(squares, axis=0)[0]
    assert expected == pytest.approx(entering)


def test_the_discharge_enters_and_stays_on_the_ground(path):
    simulation, _, _ = filled_simulation(load_scenario(path))
    simulation.start()
    simulation.advance(limit=1.0, pause=1.0, max_steps=10**6)
    totals, state = simulation.totals(), simulation.state()
    assert totals["mass_asked"] == pytest.approx(1000 * (0.5 * 0.35 + 0.5 * 0.5), rel=1e-9)
    layer = 10 * len(build_inflows(load_scenario(path), ["terrain", "flood"])[0].rows) * 0.1
    assert totals["mass_entered"] == pytest.approx(totals["mass_asked"], abs=layer)
    position = state["position"][fluid(state)]
    assert (position[:, 2] > channel(position[:, 0], position[:, 1]) - 0.05).all()
    assert position[:, 0].max() > 1.3


def test_one_that_lies_in_the_ground_is_refused(path):
    deep = load_scenario(path, ["inflow.flood.position=[1.0, 0.5, -2]"])
    with pytest.raises(UserError, match="all of its section lies in the ground"):
        filled_simulation(deep)


def test_whatever_puts_it_into_the_ground_is_blamed(path):
    turned = load_scenario(path, ["inflow.flood.direction=[0, 1, 0]"])
    with pytest.raises(UserError, match=r"^--set inflow.flood.direction: inflow.flood: "):
        filled_simulation(turned)


SURGE = """
[inflow.flood]
material = "water"
surge = [[0, 0.2, 1.0], [0.4, 0.8, 2.0], [0.8, 0.4, 1.0]]
position = [1.0, 0.5, 1.2]
direction = [1, 0, -0.2]
width = 3.0
"""


def test_a_surge_rises_and_falls_in_thickness_and_speed(path, tmp_path):
    path.write_text(text(3, dp=0.1, time=1.0, speed=5.0, more=SURGE))
    scenario = load_scenario(path)
    assert scenario.inflow["flood"].height == 0.8
    (section,) = build_inflows(scenario, ["terrain", "flood"])
    simulation, _, _ = filled_simulation(scenario)
    simulation.start()
    highest, asked = [], []
    for end in (0.15, 0.4, 0.75):
        simulation.advance(limit=end, pause=end, max_steps=10**6)
        state, totals = simulation.state(), simulation.totals()
        driven = state["motion"] == 2
        behind = (state["position"] - section.rows[0]) @ section.direction
        next_one = driven & (behind > behind[driven].max() - 0.05)
        foot = section.rows[np.argmin(section.row_height)]
        above = (state["position"][next_one] - foot) @ np.array([0.2, 0.0, 1.0]) / np.sqrt(1.04)
        highest.append(float(above.max() + section.row_height.min()))
        asked.append(totals["mass_asked"])
        speed = state["velocity"][driven] @ section.direction
        assert speed == pytest.approx(np.full(len(speed), np.interp(end, [0, 0.4, 0.8], [1, 2, 1])))
    assert highest == pytest.approx([0.2 + 0.6 * 0.15 / 0.4, 0.8, 0.45], abs=0.1)
    # Layer by layer: rows below the thickness of the moment, at the speed of the moment.
    t = np.linspace(0, 0.75, 20001)
    thick = np.interp(t, [0, 0.4, 0.8], [0.2, 0.8, 0.4])
    fast = np.interp(t, [0, 0.4, 0.8], [1, 2, 1])
    area = (section.row_height[:, None] < thick[None, ::50]).sum(axis=0) * 0.01
    exact = 1000 * np.trapezoid(area * fast[::50], t[::50])
    assert asked[-1] == pytest.approx(exact, rel=0.02)
    assert totals["mass_entered"] == pytest.approx(asked[-1], rel=0.1)


@pytest.mark.parametrize("dp", [0.2, 0.1, 0.05])
def test_a_surge_has_its_volume_whatever_the_spacing(path, dp):
    """Its area above the ground is that of a V-shaped channel: h2 over the slope of its sides."""
    grid(path.parent / "terrain.asc", channel, cell=0.02)
    t = np.linspace(0, 0.8, 2001)
    thick, fast = (np.interp(t, [0, 0.4, 0.8], of) for of in ([0.2, 0.8, 0.4], [1.0, 2.0, 1.0]))
    exact = np.trapezoid(thick**2 * fast, t) * np.sqrt(1.04) / 0.5
    path.write_text(text(3, dp=dp, speed=5.0, more=SURGE))
    scenario = load_scenario(path)
    (section,) = build_inflows(scenario, ["terrain", "flood"])
    asked, volume = surge_volumes(scenario, section)
    assert asked == pytest.approx(exact, rel=0.03)
    assert volume == pytest.approx(asked, rel=0.02)
    assert not [each for each in terrain_findings(scenario, {}) if each.place == "inflow.flood"]


@pytest.mark.parametrize("end", [0.3, 0.75, 1.0])
def test_check_tells_of_a_surge_what_the_ledger_asks_for(path, end):
    """In a V-shaped channel that is half of thickness, width and speed, or less."""
    path.write_text(text(3, dp=0.1, time=end, speed=5.0, more=SURGE))
    scenario = load_scenario(path)
    volume, most = to_enter(scenario, build_inflows(scenario, ["terrain", "flood"])[0])
    simulation, _, _ = filled_simulation(scenario)
    simulation.start()
    simulation.advance(limit=end, pause=end, max_steps=10**6)
    assert simulation.totals()["mass_asked"] == pytest.approx(1000 * volume, rel=1e-9)
    at_peak = 0.8**2 / 0.5 * np.sqrt(1.04) * 2.0
    assert most == pytest.approx(at_peak, rel=0.15) if end > 0.4 else most > 0
    said = check_scenario(scenario, threads=1)
    assert f"{volume:.4g} m3 water to enter, {most:.4g} m3/s at most" in said


def test_a_thin_fast_row_of_a_surge_is_its_largest_speed(path):
    thin = SURGE.replace("[0.8, 0.4, 1.0]]", "[0.8, 0.1, 40.0]]")
    path.write_text(text(3, dp=0.1, speed=5.0, more=thin))
    scenario = load_scenario(path)
    state = filled_simulation(scenario)[0].state()
    assert mach_number(scenario, state)[0] >= 40


def test_a_surge_fills_its_section_from_below_and_alike_on_both_sides(path):
    grid(path.parent / "terrain.asc", channel, cell=0.02)
    path.write_text(text(3, dp=0.1, speed=5.0, more=SURGE))
    (section,) = build_inflows(load_scenario(path), ["terrain", "flood"])
    order = np.argsort(section.row_height)
    height = section.rows[order, 2]
    assert (np.diff(height) > -1e-9).all()
    aside = np.abs(section.rows[order, 1] - 2.0)  # the bed is lowest there
    for level in np.unique(height.round(6)):
        assert (np.diff(aside[abs(height - level) < 1e-6]) > -1e-9).all()


def test_a_surge_of_less_than_particles_is_warned_about(path):
    rows = "[0, 0.2, 1.0], [0.4, 0.8, 2.0], [0.8, 0.4, 1.0]"
    thin = SURGE.replace(rows, "[0, 0.02, 1], [1, 0.04, 1]")
    path.write_text(text(3, dp=0.1, speed=5.0, more=thin))
    said = [str(each) for each in terrain_findings(load_scenario(path), {})]
    assert any("its layers have" in each and "m3" in each for each in said)


def test_in_2d_the_volume_of_a_surge_is_an_area(tmp_path):
    profile(tmp_path / "terrain.csv", lambda x: 1 - 0.2 * x)
    thin = SURGE.replace("[0.4, 0.8, 2.0], [0.8, 0.4, 1.0]", "[1, 0.06, 1]")
    thin = thin.replace("[0, 0.2, 1.0]", "[0, 0.01, 1]").replace("[1.0, 0.5, 1.2]", "[1.0, 0.8]")
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.1, more=thin.replace("[1, 0, -0.2]", "[1, -0.2]")))
    (said,) = [str(f) for f in terrain_findings(load_scenario(path), {}) if "layers" in str(f)]
    assert "m2, and thickness and speed make" in said
    assert "m3" not in said


def test_a_surge_from_a_file_of_time_thickness_and_velocity(path, tmp_path):
    (tmp_path / "surge.csv").write_text(
        "timestep,thickness,velocity\n0,0.2,1\n0.4,0.8,2\n0.8,0.4,1\n"
    )
    path.write_text(text(3, dp=0.1, more=SURGE.replace(
        "[[0, 0.2, 1.0], [0.4, 0.8, 2.0], [0.8, 0.4, 1.0]]", '"surge.csv"')))  # fmt: skip
    scenario = load_scenario(path)
    assert scenario.inflow["flood"].surge == [[0, 0.2, 1], [0.4, 0.8, 2], [0.8, 0.4, 1]]
    again = path.with_name("again.toml")
    again.write_text(scenario.effective_toml())
    assert load_scenario(again).inflow["flood"].surge == scenario.inflow["flood"].surge


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("rate = 0.2", "exclude each other"),
        ("depth = 0.2", "exclude each other"),
        ("duration = 3", "exclude each other"),
        ("surge = [[0, 1]]", "thickness, velocity"),
        ("surge = [[0, 0.2, 1], [1, -0.2, 1]]", "thickness = -0.2"),
        ("surge = [[0, 0.2, 1], [0, 0.2, 1]]", "times must go on"),
    ],
)
def test_what_is_no_surge_is_refused(path, change, said):
    words = text(3, dp=0.1, more=SURGE)
    if change.startswith("surge"):
        words = "\n".join(
            change if line.startswith("surge") else line for line in words.splitlines()
        )
    else:
        words += change + "\n"
    path.write_text(words)
    with pytest.raises(UserError, match=said):
        load_scenario(path)


def test_a_dry_channel_waits_for_what_comes_later(path):
    """Nothing is there before; it ends where nothing is left and nothing comes."""
    simulation, _, _ = filled_simulation(load_scenario(path, ["inflow.flood.start=0.3"]))
    simulation.start()
    simulation.advance(limit=0.2, pause=0.2, max_steps=10**6)
    assert len(simulation) == 0
    assert simulation.time == pytest.approx(0.2)
    simulation.advance(limit=0.8, pause=0.8, max_steps=10**6)
    assert simulation.totals()["mass_entered"] > 100
    assert fluid(simulation.state()).any()


@pytest.mark.parametrize("inflow", [INFLOW, SURGE])
def test_one_beyond_the_map_is_refused(path, inflow):
    """All that entered there would leave at once."""
    path.write_text(text(3, dp=0.1, speed=5.0, more=inflow))
    for place in ("[5000.0, 0.5, 1.2]", "[1.0, 2.5, 2.8]"):  # far away, and half of its width
        scenario = load_scenario(path, [f"inflow.flood.position={place}"])
        with pytest.raises(UserError, match=r"flood: its section reaches beyond the terrain"):
            build_inflows(scenario, ["terrain", "flood"])


@pytest.mark.parametrize("inflow", [INFLOW, SURGE])
def test_one_in_the_air_is_warned_about(path, inflow):
    path.write_text(text(3, dp=0.1, speed=5.0, more=inflow))
    high = load_scenario(path, ["inflow.flood.position=[1.0, 0.5, 7.0]"])
    said = [str(each) for each in terrain_findings(high, {})]
    assert any("its section begins 4.36" in each for each in said)
    low = load_scenario(path)
    assert not any("its section begins" in str(each) for each in terrain_findings(low, {}))


def test_what_a_dry_scene_takes_is_not_known_before_something_enters(path):
    """Every quantity is that of particles, and there are none to measure."""
    late = load_scenario(path, ["inflow.flood.start=0.9", "time_max=0.1"])
    said = check_scenario(late)
    assert "not known: nothing has entered" in said
    assert "begins" not in said
