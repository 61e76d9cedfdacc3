"""Hydrographs and normal depths in a scenario file."""

from __future__ import annotations

import math

import numpy as np
import pytest

from doseki.assess.preflight import check_scenario
from doseki.errors import UserError
from doseki.scenario.hydrographs import keulegan_rate, normal_depth
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies
from doseki.scene.inflow_sections import build_inflows, to_enter
from doseki.solver.build import build_simulation

from ..small_scenarios import BLOCK

INFLOW = """
[inflow.i]
material = "water"
hydrograph = [[0, "0 L/s"], [1, "3 L/s"], [7, 0]]
width = 0.1
position = [0, 2]
direction = [1, 0]
depth = 0.4
start = 0.5
"""
LIST = '[[0, "0 L/s"], [1, "3 L/s"], [7, 0]]'


def section_of(path):
    scenario = load_scenario(path)
    particles, names = build_bodies(scenario)
    return build_inflows(scenario, names, particles)[0]


def test_rows_with_units_become_speeds_and_distances(write):
    section = section_of(write(tables=INFLOW))
    peak = 0.003 / 0.1 / 0.4
    np.testing.assert_allclose(section.times, [0.5, 1.5, 7.5])
    np.testing.assert_allclose(section.speeds, [0, peak, 0])
    np.testing.assert_allclose(section.distances, [0, 0.5 * peak, 3.5 * peak])
    assert section.rate_mass == pytest.approx(30)
    volume = section.entered(np.array([0.0, 1.0, 1.5, 9.0])) * 0.1**2 * 0.1
    np.testing.assert_allclose(volume, [0, 0.003 / 8, 0.0015, 0.0105], atol=1e-15)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("t,Q\n0,0.001\n2,0.003\n", [[0, 0.001], [2, 0.003]]),
        ("t [s], Q [L/s]\n# rising\n0, 1\n2, 3\n", [[0, 0.001], [2, 0.003]]),
        ("Q [m3/s],t [min]\n0.001,0\n0.003,1\n", [[0, 0.001], [60, 0.003]]),
    ],
)
def test_a_csv_file_says_the_same(write, tmp_path, text, expected):
    (tmp_path / "q.csv").write_text(text)
    path = write(tables=INFLOW.replace(LIST, '"q.csv"'))
    rows = load_scenario(path).inflow["i"].rows
    np.testing.assert_allclose(rows - np.array([0.5, 0.0]), expected)


def test_the_effective_scenario_no_longer_needs_the_file(write, tmp_path):
    (tmp_path / "q.csv").write_text("t,Q\n0,0.001\n2,0.003\n")
    scenario = load_scenario(write(tables=INFLOW.replace(LIST, '"q.csv"')))
    (tmp_path / "q.csv").unlink()
    (tmp_path / "again.toml").write_text(scenario.effective_toml())
    again = load_scenario(str(tmp_path / "again.toml"))
    np.testing.assert_array_equal(again.inflow["i"].rows, scenario.inflow["i"].rows)


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        (LIST, "[[0, 1], [2, 1], [1, 1]]", ["i.hydrograph", "row 3: t = 1 s goes back", "2 s"]),
        (LIST, "[[0, 1], [2, -1]]", ["i.hydrograph", "row 2: Q = -1", "from 0 to 1e+12"]),
        (LIST, '[[0, 1], [2, "-1 L/s"]]', ["row 2: Q = -0.001", "from 0 to 1e+12"]),
        (LIST, "[[0, 1]]", ["i.hydrograph", "1 row; two or more are needed"]),
        (LIST, "[]", ["no rows; two or more"]),
        (LIST, "[[0, 1], [2]]", ["must be a list of [t, Q] pairs, or the path of a CSV file"]),
        (LIST, '[[0, 1], [2, "3 gal/s"]]', ['hydrograph.1.1 = "3 gal/s" is not a rate']),
        (LIST, "[[0, 1], [2, true]]", ["row 2: Q = True"]),
        (LIST, "[[0, 1], [2, inf]]", ["row 2: Q = inf"]),
        (LIST, "[[0, 0], [2, 0]]", ["nothing would enter"]),
        (LIST, "[[0, 0], [1, 0], [1, 5], [1, 0], [2, 0]]", ["i.hydrograph", "nothing would enter"]),
        (LIST, '"none.csv"', ["i.hydrograph", "none.csv: no such file"]),
        ("start", 'rate = "3 L/s"\nstart', ["inflow.i.rate and inflow.i.hydrograph exclude"]),
        ("start", "duration = 1\nstart", ["inflow.i.duration and inflow.i.hydrograph exclude"]),
        (f"hydrograph = {LIST}", "duration = 1", ["inflow.i.rate is missing, or a hydrograph"]),
        (f"hydrograph = {LIST}", "rate = 1", ["inflow.i.duration is missing, which goes with"]),
        ("depth = 0.4", 'depth = "normal"', ["goes with a constant rate"]),
        ("depth = 0.4", 'depth = "deep"', ["inflow.i.depth", '"deep"', '"normal"']),
        ("depth = 0.4", "depth = 0", ["inflow.i.depth", "must be a length in m"]),
        ("[0, 2]", "[0.55, -0.02]", ["inflow.i.position = [0.55, -0.02]", "inside the wall block"]),
    ],
)
def test_wrong_hydrographs(write, error_of, old, new, parts):
    assert old in INFLOW
    block = BLOCK.replace("[body.block]", "[body.block]\nfixed = true")
    message = error_of(write(tables=block + INFLOW.replace(old, new)))
    assert "case.toml" in message
    for part in parts:
        assert part in message


@pytest.mark.parametrize(("mark", "word"), [(";", "semicolons"), ("\t", "tabs")])
@pytest.mark.parametrize("row", ["2{}0.003", "2,0{}0,003"])
def test_another_separator_is_named(write, tmp_path, mark, word, row):
    (tmp_path / "q.csv").write_text(f"t{mark}Q\n{row.format(mark)}\n", encoding="utf-8")
    with pytest.raises(UserError, match=rf"q\.csv: its columns are separated by {word}; expected"):
        load_scenario(write(tables=INFLOW.replace(LIST, '"q.csv"')))


def test_the_volume_that_enters_is_that_of_the_rows(write):
    """Of a surge the product of thickness and speed, both linear in time."""
    inflow = load_scenario(write(tables=INFLOW)).inflow["i"]
    assert inflow.volume_between(0, 99) == pytest.approx(0.0105)
    assert inflow.volume_between(0, 1.0) == pytest.approx(0.003 / 8)
    assert inflow.volume_between(9, 99) == 0.0
    surge = INFLOW.replace(f"hydrograph = {LIST}", "surge = [[0, 0, 0], [1, 0.4, 3], [2, 0, 0]]")
    surge = surge.replace("depth = 0.4\n", "")
    for end, volume in ((99, 2 * 0.4 * 3 / 3), (1.0, 0.4 * 3 * 0.5**3 / 3)):
        scenario = load_scenario(write(tables=surge), [f"time_max={end}", "dp=0.01"])
        (section,) = build_inflows(scenario, ["i"])
        assert to_enter(scenario, section)[0] == pytest.approx(volume, rel=0.02)


def surge_of(rows):
    """The inflow with a surge in place of its hydrograph."""
    return INFLOW.replace(f"hydrograph = {LIST}", f"surge = {rows}").replace("depth = 0.4\n", "")


JUMP = [[0, 0.4, 1], [1, 0.4, 1], [1, 0.2, 2], [2, 0.2, 2]]


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_surge_may_jump(write):
    """Two rows of one time: no time passes between them."""
    scenario = load_scenario(write(tables=surge_of(JUMP)), ["time_max=9", "dp=0.02"])
    (section,) = build_inflows(scenario, ["i"])
    when = np.array([0.6, 1.5, 1.6, 2.4])
    np.testing.assert_allclose(section.time_of(section.gone(when)), when)
    assert to_enter(scenario, section)[0] == pytest.approx(0.8, rel=1e-6)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("rows", [JUMP, [[0, 0.4, 0], [1, 0, 2], [2, 0.4, 0]]])
def test_a_surge_of_which_some_stretch_carries_is_taken(write, rows):
    """Thickness and speed need not be above 0 in the same row."""
    check_scenario(load_scenario(write(tables=surge_of(rows)), ["time_max=9", "xi=0.2"]))


@pytest.mark.parametrize(
    "rows",
    [
        [[0, 0.4, 0], [1, 0.4, 0], [1, 0.4, 2], [1, 0.4, 0], [2, 0.4, 0]],
        [[0, 0, 2], [1, 0, 2], [1, 0.4, 0], [2, 0.4, 0]],
    ],
)
def test_a_surge_of_which_no_stretch_carries_is_refused(write, error_of, rows):
    message = error_of(write(tables=surge_of(rows)))
    assert "case.toml" in message
    assert "inflow.i.surge" in message
    assert "nothing would enter; times must go on while thickness and velocity" in message


def test_a_check_tells_the_volume(write):
    told = check_scenario(load_scenario(write(tables=INFLOW)))
    assert "inflow i          0." in told


@pytest.mark.parametrize("setting", ["rate=3", "duration=3"])
def test_a_setting_that_takes_the_place_of_the_hydrograph_says_so(write, setting):
    with pytest.raises(UserError, match=r"missing.* exclude") as caught:
        load_scenario(write(tables=INFLOW), [f"inflow.i.{setting}"])
    assert "hydrograph" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("time,Q\n0,1\n1,1\n", "no column t"),
        ("t,Q [gal/s]\n0,1\n1,1\n", 'unit of "Q [gal/s]" is not known; allowed: m3/s'),
        ("t,Q\n0,1\n1,x\n", "row 2: Q = 'x' is not a number"),
        ("t,Q\n0,1\n1,1_0\n", "row 2: Q = '1_0' is not a number"),
        ("t,Q\n0,1\n1,5\0\n", "line 3: a NUL byte"),
        ("t,Q\n0,1\n1,1e300\n", "row 2: Q = 1e+300; allowed: numbers from 0 to 1e+12"),
        ("t,Q\n0,1\n1,nan\n", "row 2: Q = nan"),
        ("t,Q\n0,1\n-1,1\n", "row 2: t = -1"),
        ("", 'q.csv: the file is empty; expected a CSV header such as "t [s],Q [L/s]"'),
        ("0,0\n1,30\n", 'q.csv: begins with numbers; a header such as "t [s],Q [L/s]" must'),
        ("t,Q\n", "q.csv: no rows; two or more are needed"),
        ("t,Q,x\n0,1,1\n1,1,1\n", '"x" is not one of its columns: take it out; expected'),
        ("t,Q\n0,1\n1\n", "line 3: 1 field; the header has 2 columns"),
    ],
)
def test_wrong_files(write, error_of, tmp_path, text, part):
    (tmp_path / "q.csv").write_text(text)
    message = error_of(write(tables=INFLOW.replace(LIST, '"q.csv"')))
    assert "case.toml, line" in message
    assert "q.csv" in message
    assert part in message


def test_a_section_on_a_wall_is_allowed(write):
    block = BLOCK.replace("[body.block]", "[body.block]\nfixed = true")
    assert section_of(write(tables=block + INFLOW.replace("[0, 2]", "[0.5, 0.5]"))).speed > 0


STONE = """
[body.stone]
shape = "box"
material = "basalt"
kinematics = "rigid"
min = [0, 0]
max = [1, 0.5]
"""


@pytest.mark.parametrize(("tables", "name"), [(BLOCK, "block"), (STONE, "stone")])
@pytest.mark.parametrize(
    ("place", "direction", "clear"),
    [
        ("[0, 0.05]", "[1, 0]", True),
        ("[1, 0.05]", "[-1, 0]", True),
        ("[0, 0.05]", "[-1, 0]", False),
        ("[0.3, 0.05]", "[1, 0]", False),
        ("[1.05, 0.05]", "[1, 0]", False),
    ],
)
def test_layers_do_not_begin_inside_what_moves(write, tables, name, place, direction, clear):
    inflow = INFLOW.replace("[0, 2]", place).replace("[1, 0]\n", f"{direction}\n")
    path = write('scheme = "resolved"\nspeed_max = 2', tables + inflow)
    if clear:
        assert section_of(path).speed > 0
        return
    with pytest.raises(UserError, match=rf"its layers begin inside {name}, at \[.*\] m; keep"):
        section_of(path)


NORMAL = """
[inflow.i]
material = "water"
rate = "20 L/s"
width = 0.5
position = [5, 0]
direction = [-1, 0]
depth = "normal"
ks = 0.005
duration = 2
"""


def test_normal_depth_balances_friction_and_gravity(write):
    """tau = rho g h sin(slope) = rho (U/(6.25 + 5.75 log10(h/ks)))^2."""
    scenario = load_scenario(write("slope = 5", NORMAL))
    h = scenario.inflow["i"].depth
    mean = 0.04 / h
    shear = (mean / (6.25 + 5.75 * math.log10(h / 0.005))) ** 2
    assert shear == pytest.approx(9.8 * math.sin(math.radians(5)) * h, rel=1e-9)
    assert 0.01 < h < 0.05


@pytest.mark.parametrize("depth", [0.011, 0.1, 3.0])
def test_normal_depth_inverts_the_law(depth):
    rate = keulegan_rate(depth, 0.3, 0.01)
    assert normal_depth(rate, 0.3, 0.01) == pytest.approx(depth, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("ks = 0.005\n", "", "inflow.i.ks is missing"),
        ("[-1, 0]", "[1, 0]", "needs a flow down a slope"),
        ("0.005", "5", "inflow.i.ks = 5 m: the normal depth would be less than ks"),
    ],
)
def test_wrong_normal_depths(write, error_of, old, new, part):
    assert part in error_of(write("slope = 5", NORMAL.replace(old, new)))


def test_a_simulation_lets_in_what_the_hydrograph_says(write):
    path = write("slope = 0\nxi = 0.05", BLOCK + INFLOW.replace("start = 0.5", "start = 0.1"))
    simulation, _ = build_simulation(load_scenario(path, ["dp=0.05", "time_max=2"]))
    simulation.advance(limit=0.7, pause=0.7, max_steps=10**6)
    entered = 1000 * 0.003 * 0.6**2 / 2 / 0.1
    totals = simulation.totals()
    assert totals["mass_asked"] == pytest.approx(entered, rel=1e-9)
    assert abs(totals["mass_entered"] - entered) <= 0.5 * 1000 * 0.4 * 0.05 * (1 + 1e-9)


def test_a_file_of_an_option_is_looked_for_here(write, error_of, tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    said = error_of(write(tables=INFLOW), "inflow.i.hydrograph=sub/hy.csv")
    place = f"sub/hy.csv: no such file in {tmp_path / 'here' / 'sub'}"
    assert said == f"--set inflow.i.hydrograph: inflow.i.hydrograph: {place}"
