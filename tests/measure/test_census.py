"""Classes of grains on states made by hand, and what a census counts."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import h5py
import numpy as np
import pytest

from doseki.cli.main import main
from doseki.errors import UserError
from doseki.figures.census_output import census_lines
from doseki.measure.census.census import (
    CARRIED,
    CLASSES,
    DEPOSITED,
    FLOATING,
    PRECEDING,
    ROLLING,
    WAITING,
    Census,
    Grains,
    Surroundings,
    classify,
    deposit_outline,
    draw_speeds,
    grains_of,
    take_census,
)
from doseki.measure.views import View, fluid_names
from doseki.record.reader import load

from ..assess.accounts import recorded
from ..small_scenarios import CHALK
from ..synthetic_runs import flow_state

D = 0.01  # m, of the grains
FAST, SLOW = 1.0, 0.01  # m/s


def grains(dim, position, speed):
    """Grains of diameter D; the middle axis of 3-D is zero."""
    position = np.array(position, float)
    if dim == 3:
        position = np.insert(position, 1, 0.0, axis=1)
    n = len(position)
    velocity = np.zeros((n, dim))
    velocity[:, 0] = -np.array(speed)
    return Grains(
        np.arange(n),
        position,
        velocity,
        np.zeros((n, 3)),
        np.zeros(n, int),
        np.full(n, D),
        np.ones(n),
        np.zeros(n, bool),
    )


def film(dim, start, end, depth, spacing=0.0025):
    """Water from `start` to `end` over a bed whose surface is at zero, from -0.2 m to 1 m."""
    across = (np.arange(-10, 10) + 0.5) * spacing if dim == 3 else np.zeros(1)

    def block(low, high, bottom, top):
        x = np.arange(low + spacing / 2, high, spacing)
        z = np.arange(bottom + spacing / 2, top, spacing)
        points = np.stack(np.meshgrid(x, across, z, indexing="ij"), -1).reshape(-1, 3)
        return points if dim == 3 else points[:, [0, 2]]

    water, bed = block(start, end, 0, depth), block(-0.2, 1, -2 * spacing, 0)
    return Surroundings(water, np.full(len(water), spacing**dim), bed, np.full(len(bed), spacing))


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request):
    """Number of space dimensions."""
    return request.param


# Water 20 mm deep has come from x = 1 down to x = 0.5 and flows towards -x.
HEIGHT = {ROLLING: 0.5 * D, CARRIED: 0.009, FLOATING: 0.018}


def kinds_of(dim, position, speed, moved=1.0, direction=-1, water=(0.5, 1.0, 0.02)):
    """(class of each grain, front)."""
    some = grains(dim, position, speed)
    return classify(some, some.position + moved * D, film(dim, *water), direction)


def test_each_class_once(dim):
    position = [
        (0.3, HEIGHT[ROLLING]),
        *((0.55 + 0.1 * k, z) for k, z in enumerate(HEIGHT.values())),
    ]
    kinds, front = kinds_of(dim, position, FAST * np.ones(4))
    assert front == pytest.approx(0.5, abs=2 * D)
    assert [CLASSES[k] for k in kinds] == ["preceding", "rolling", "carried", "floating"]


def test_what_rests_waits_until_it_has_moved(dim):
    position = [(0.3, HEIGHT[ROLLING]), (0.7, HEIGHT[ROLLING])]
    assert list(kinds_of(dim, position, [SLOW, 0], moved=0.5)[0]) == [WAITING, WAITING]
    assert list(kinds_of(dim, position, [SLOW, 0], moved=1.5)[0]) == [DEPOSITED, DEPOSITED]


def test_the_flow_may_run_either_way(dim):
    position = [(0.3, HEIGHT[CARRIED]), (0.7, HEIGHT[CARRIED])]
    assert list(kinds_of(dim, position, [FAST, FAST])[0]) == [PRECEDING, CARRIED]
    water = (0.0, 0.5, 0.02)
    forward, front = kinds_of(dim, position, [-FAST, -FAST], direction=1, water=water)
    assert list(forward) == [CARRIED, PRECEDING]
    assert front == pytest.approx(0.5, abs=2 * D)


def test_without_water_what_moves_precedes_it(dim):
    kinds, front = kinds_of(
        dim, [(0.3, HEIGHT[CARRIED]), (0.7, 0.1)], [FAST, SLOW], water=(0, 0, 0)
    )
    assert math.isnan(front)
    assert list(kinds) == [PRECEDING, DEPOSITED]


def test_a_grain_on_the_bed_of_a_shallow_film_rolls(dim):
    kinds, _ = kinds_of(dim, [(0.7, 0.5 * D)], [FAST], water=(0.5, 1.0, 0.005))
    assert list(kinds) == [ROLLING]


def test_a_drop_ahead_is_no_front(dim):
    some = grains(dim, [(0.3, HEIGHT[CARRIED])], [FAST])
    around = film(dim, 0.5, 1.0, 0.02)
    drop = np.zeros((1, dim))
    drop[0, -1] = 0.01
    volume = np.append(around.water_volume, around.water_volume[0])
    spray = Surroundings(
        np.concatenate([around.water, drop]), volume, around.fixed, around.fixed_spacing
    )
    assert (
        classify(some, some.position, spray, -1)[1] == classify(some, some.position, around, -1)[1]
    )


@pytest.mark.parametrize("direction", [-1, 1])
def test_spray_ahead_is_no_front_and_a_flow_is(dim, direction):
    """2 mm of water on the mean, or 6 mm, run 0.3 m ahead of 20 mm."""
    some = grains(dim, [(0.3, HEIGHT[CARRIED])], [FAST])
    block = film(dim, 0.5, 1.0, 0.02)
    for depth, front in {0.002: 0.5, 0.006: 0.2}.items():
        thin = film(dim, 0.2, 0.5, depth, spacing=0.001 if depth < 0.0025 else 0.002)
        around = Surroundings(
            np.concatenate([block.water, thin.water])
            * np.where(np.arange(dim) == 0, -direction, 1),
            np.concatenate([block.water_volume, thin.water_volume]),
            block.fixed * np.where(np.arange(dim) == 0, -direction, 1),
            block.fixed_spacing,
        )
        found = classify(some, some.position, around, direction)[1]
        assert found == pytest.approx(-direction * front, abs=2 * D)


def made_census(dim=2):
    """Two grains: one runs from 1 m to beyond 0 and vanishes, the other stays."""
    time = np.array([0.0, 0, 1, 1, 2])
    ids = np.array([0, 1, 0, 1, 1])
    x = np.zeros((5, dim))
    x[:, 0] = [1, 2, -0.2, 2, 2]
    table = {
        "time": time, "id": ids, "position": x, "velocity": np.ones((5, dim)), "mass": ids + 1.0,
        "kind": np.array([WAITING, WAITING, CARRIED, WAITING, DEPOSITED]),
        "diameter": np.full(5, D), "is_part": np.zeros(5, bool), "is_load": np.ones(5, bool),
        "source": np.array([-1, -1, 0, 1, 1]),
    }  # fmt: skip
    return Census(np.array([0.0, 1.0, 2.0]), np.full(3, math.nan), table, -1)


def test_masses_over_time():
    census = made_census()
    assert census.load_mass == 3.0
    np.testing.assert_array_equal(census.mass_of(WAITING), [3, 2, 0])
    np.testing.assert_array_equal(census.mass_of(DEPOSITED), [0, 0, 2])


def test_passed_mass_counts_what_has_left_the_run():
    np.testing.assert_array_equal(made_census().passed(0.0), [0, 1, 1])
    np.testing.assert_array_equal(made_census().passed(1.5), [0, 0, 0])


def test_passed_grains_come_from_either_side_where_nothing_says_the_direction():
    """One grain goes from 1 m to -0.2 m, on level ground without an inflow."""
    census = replace(made_census(), direction=0)
    np.testing.assert_array_equal(census.passed(0.0), [0, 1, 1])
    assert census.passed_count(0.0) == 1


@pytest.mark.parametrize(
    ("direction", "told"),
    [
        (-1, "passed x = 0 m towards -x at the end: 1 grain, 0.01 % of the load"),
        (0, "passed x = 0 m either way at the end: 1 grain, 0.01 % of the load"),
    ],
)
def test_one_grain_of_ten_thousand_is_told(direction, told):
    census = replace(made_census(), direction=direction)
    census.table["mass"][[1, 3, 4]] = 9999.0
    drawn = draw_speeds(np.ones(3))
    lines = census_lines(census, drawn, "everywhere", [0.0])
    assert lines[-1] == told
    assert "carried 0.01 %" in lines[1]


def test_rows_by_window_and_time():
    census = made_census()
    view = View(np.array([-1.0, -1.0]), np.array([1.5, 1.0]))
    assert list(census.rows(view)) == [True, False, True, False, False]
    assert list(census.rows(view, 0.5, 1.0)) == [False, False, True, False, False]


def test_draws_of_thirty_vary_as_they_should():
    """Samples of 30 without replacement: standard error s/sqrt(30) sqrt(1 - 30/N)."""
    speeds = np.random.default_rng(3).uniform(0, 2, 600)
    drawn = draw_speeds(speeds, draws=4000)
    assert drawn.counts.sum() == 600
    np.testing.assert_allclose(drawn.edges[:3], [0, 0.1, 0.2])
    assert drawn.mean.sum() == pytest.approx(30)
    assert drawn.sample_means.mean() == pytest.approx(speeds.mean(), abs=0.01)
    error = speeds.std() / math.sqrt(30) * math.sqrt(1 - 30 / 600)
    assert drawn.sample_means.std() == pytest.approx(error, rel=0.05)


def test_draws_of_few_and_of_none():
    assert draw_speeds(np.ones(4)).size == 4
    assert draw_speeds(np.zeros(0)).size == 0


def test_outline_of_a_heap():
    census = made_census()
    census.table["position"][4] = [2.0, 0.3]
    everywhere = View(np.full(2, -np.inf), np.full(2, np.inf))
    np.testing.assert_allclose(deposit_outline(census, everywhere), [[2.005, 0.305]], atol=0.0051)
    nowhere = View(np.full(2, 5.0), np.full(2, 6.0))
    assert deposit_outline(census, nowhere).shape == (0, 2)


def test_outline_in_plan():
    n = 30
    x = np.random.default_rng(2).uniform(0.1, 0.9, (n, 3))
    x[:4, :2] = [(0, 0), (1, 0), (1, 1), (0, 1)]
    table = {
        "time": np.zeros(n),
        "position": x,
        "kind": np.full(n, DEPOSITED),
        "diameter": np.full(n, D),
    }
    census = Census(np.zeros(1), np.zeros(1), table, -1)
    outline = deposit_outline(census, View(np.full(3, -np.inf), np.full(3, np.inf)))
    assert {tuple(point) for point in outline} == {(0, 0), (1, 0), (1, 1), (0, 1)}


def test_particles_are_grains_where_there_is_no_table(flow_folder):
    run = load(flow_folder)
    found = grains_of(run[0], fluid_names(run), set())
    assert len(found.id) == 3
    np.testing.assert_allclose(found.diameter, 0.1 * math.sqrt(4 / math.pi))
    assert np.isnan(found.spin).all()


def test_the_command_writes_tables_and_figures(flow_folder, capsys):
    with pytest.raises(SystemExit) as done:
        main(["census", str(flow_folder), "--window", "end", "--section", "0", "--section", "0.5"])
    assert done.value.code == 0
    told = capsys.readouterr().out
    assert "3 grains at 13 times" in told
    assert "passed x = 0.5 m towards -x at the end: " in told
    folder = flow_folder / "census"
    with (folder / "grains.csv").open() as file:
        rows = list(csv.DictReader(file))
    census = take_census(load(flow_folder))
    assert len(rows) == len(census.table["time"])
    assert float(rows[5]["x"]) == pytest.approx(census.table["position"][5, 0], rel=1e-6)
    with h5py.File(folder / "census.h5") as file:
        np.testing.assert_allclose(file["grains"]["x"][:], census.table["position"][:, 0])
        np.testing.assert_allclose(file["passed"]["x = 0"][:], census.passed(0.0))
        assert file["grains"]["class"][0].decode() in CLASSES
    assert {"classes.png", "speeds.png", "passed.png"} <= {path.name for path in folder.iterdir()}


def test_zero_is_no_section_of_a_map(tmp_path, record_run, capsys):
    """Where the scene has no x = 0, nothing is said to have passed it, but how to say where."""

    def on_a_map(time):
        state = flow_state(time)
        return state | {"position": state["position"] + [500000, 0]}

    record_run(tmp_path / "run", state_at=on_a_map)
    with pytest.raises(SystemExit) as done:
        main(["census", str(tmp_path / "run")])
    told = capsys.readouterr().out
    assert done.value.code == 0
    assert "passed x" not in told
    assert "x = 0 is not in the scene, which goes from 49999" in told
    assert "say where with --section X" in told
    assert not (tmp_path / "run" / "census" / "passed.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["--window", "ende"], "did you mean end?"),
        (["--from", "2", "--to", "1"], "--to = 1 s must not be before --from = 2 s"),
    ],
)
def test_mistakes(flow_folder, capsys, arguments, part):
    with pytest.raises(SystemExit) as caught:
        main(["census", str(flow_folder), *arguments])
    assert caught.value.code == 2
    assert part in capsys.readouterr().err


def test_a_run_without_grains_has_no_census(tmp_path, record_run, plain_state):
    def water(time):
        return plain_state(np.zeros((1, 2)), np.zeros((1, 2)), np.array([0]))

    record_run(tmp_path / "run", state_at=water)[0].close({})
    with pytest.raises(UserError, match="no grains"):
        take_census(load(tmp_path / "run"))


ALL_DUST = """
dim = 2
dp = 0.005
scheme = "resolved"
speed_max = 6
time_max = 0.002
time_out = 0.001
gravity = [0, 0]

[body.disc]
shape = "disc"
material = "chalk"
kinematics = "elastic"
centre = [0, 0.0205]
radius = 0.02
velocity = [0, -10]

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.1, -0.02]
max = [0.1, 0]
"""


def test_a_body_that_is_all_dust_is_no_more(tmp_path, capsys):
    """Its row stays, and the census does not count it."""
    weak = CHALK.replace("1e5", "3e4").replace("energy = 1", "energy = 0.01")
    run = recorded(tmp_path, ALL_DUST + weak)
    table = run[-1].grains
    assert (table["removed"][0], table["mass"][0]) == (1, 0)
    assert table["mass"].sum() == pytest.approx(run[0].grains["mass"][0])
    living = np.count_nonzero(table["removed"] == 0)
    assert living == np.count_nonzero(table["parent"] >= 0) > 10
    with pytest.raises(SystemExit):
        main(["census", str(tmp_path / "run")])
    assert f"1 grain at first and {living} at last, at 3 times" in capsys.readouterr().out
