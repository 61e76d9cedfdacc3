"""The flume's criteria on records whose numbers are known, and the page that compares two runs."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.cli.main import main
from doseki.errors import UserError
from doseki.record.reader import load
from doseki.studies.flume_criteria import (
    AHEAD,
    BALANCE,
    CRITERIA,
    FLOATS,
    NOT_MEASURED,
    PASSED,
    RATIO,
    SPEED,
    STUCK,
    measure_flume,
    verdicts,
)
from doseki.validate.judging import FAIL, PASS, SHORT

WATER, GRAIN, BED = 0, 1, 2
TABLES = """\
scheme = "{scheme}"

[window.outlet]
min = [0, -0.2]
max = [1, 0.5]

[window.load]
min = [1.5, -0.2]
max = [3, 0.5]

[inflow.water]
material = "water"
rate = 1
width = 1
position = [3, 0]
direction = [-1, 0]
depth = 0.1
duration = 5
"""
TIMES = tuple(np.arange(0, 8.01, 0.2))
FIRST = np.linspace(2, 2.45, 10)  # m, the load


def flume_state(plain_state, time, speed, carried, grain_speed, left):
    """Water with its front at 3 - `speed` t, 1 kg/s of it; one grain ahead, the others taken along.

    Grains run at `grain_speed` once the water has reached them, the first from the start and faster
    than the water; the last `left` never do.  `carried` is their height over the bed.
    """
    late = np.maximum(time - (3 - FIRST) / speed, 0)
    x_grain = FIRST - grain_speed * late
    x_grain[0] = 2 - 1.5 * speed * time
    resting = late == 0
    resting[0] = False
    if left:
        resting[-left:], x_grain[-left:] = True, FIRST[-left:]
    x_water = np.arange(3, max(3 - speed * time, -1), -0.025 * speed) if time else np.zeros(0)
    x_bed = np.arange(-1, 3.5, 0.1)
    x = np.concatenate([x_water, x_grain, x_bed])
    kind = np.repeat([WATER, GRAIN, BED], [len(x_water), len(x_grain), len(x_bed)])
    height = np.array([0.05, carried, -0.05])[kind]
    velocity = np.array([-speed, -grain_speed, 0.0])[kind]
    velocity[kind == GRAIN] *= ~resting
    state = plain_state(np.column_stack([x, height]), np.column_stack([velocity, 0 * x]), kind)
    water = kind == WATER
    layers = round(speed * time / (0.025 * speed))
    state["id"] = np.concatenate(
        [10_000 + layers - np.arange(len(x_water)), np.arange(10), 1000 + np.arange(len(x_bed))]
    )
    state["mass"][water], state["density"][water] = 0.025, 1.0
    return state


@pytest.fixture
def flume(tmp_path, record_run, plain_state):
    """A function that records a run of the flume and gives its folder."""

    def make(scheme="resolved", speed=2.0, carried=0.4, grain_speed=1.8, left=0, times=TIMES):
        folder = tmp_path / scheme
        recorder, _ = record_run(
            folder,
            times=times,
            state_at=lambda t: flume_state(plain_state, t, speed, carried, grain_speed, left),
            tables=TABLES.format(scheme=scheme),
        )
        recorder.close({})
        return folder

    return make


def measured(folder):
    """Number by criterion."""
    return {name: v.number for name, v in measure_flume(load(folder)).outcome.values.items()}


def test_numbers_are_those_of_the_record(flume):
    found = measured(flume())
    assert found[SPEED] == pytest.approx(2.0)
    assert found[BALANCE] == pytest.approx(1.0, abs=0.02)
    assert found[AHEAD] == pytest.approx(0.1)
    assert 0.2 < found[FLOATS] <= 0.9
    assert found[PASSED] == pytest.approx(1.0)
    assert found[STUCK] == 0
    assert found[RATIO] == pytest.approx(0.9)


def test_a_run_that_agrees_meets_every_criterion(flume):
    assert {row.verdict for row in verdicts(measure_flume(load(flume())))} == {PASS}


@pytest.mark.parametrize(
    ("changes", "missed"),
    [
        ({"speed": 1.2, "grain_speed": 1.1}, {SPEED}),
        ({"carried": 0.05}, {FLOATS}),
        ({"grain_speed": 1.2}, {RATIO}),
        ({"left": 2}, {PASSED, STUCK}),
    ],
)
def test_each_criterion_is_missed_where_it_should_be(flume, changes, missed):
    rows = verdicts(measure_flume(load(flume(**changes))))
    assert {row.quantity: row.verdict for row in rows if row.verdict != PASS} == dict.fromkeys(
        missed, FAIL
    )


def test_the_scheme_of_the_paper_falls_short(flume):
    rows = verdicts(measure_flume(load(flume("ueta2022", grain_speed=1.2))))
    assert {row.quantity: row.verdict for row in rows if row.verdict != PASS} == {RATIO: SHORT}


def test_what_a_run_ends_too_early_for_is_not_measured(flume):
    rows = verdicts(measure_flume(load(flume(times=TIMES[:6]))))
    found = {row.quantity: row.verdict for row in rows if row.verdict == NOT_MEASURED}
    assert set(found) == {SPEED, BALANCE, FLOATS, PASSED, STUCK, RATIO}


@pytest.mark.minutes
def test_a_page_of_runs_to_which_no_water_came_has_no_verdict(flume, tmp_path, capsys):
    runs = [str(flume(scheme, times=TIMES[:3])) for scheme in ("ueta2022", "resolved")]
    with pytest.raises(SystemExit) as done:
        main(["compare", "flume", *runs, "--out", str(tmp_path / "page")])
    assert done.value.code == 0
    told = capsys.readouterr().out
    assert told.count("| not measured |") == 2 * len(CRITERIA)
    assert "nan" not in told
    assert "missed" not in told
    page = (tmp_path / "page" / "comparison.md").read_text()
    assert "resolved-fig7 is not drawn: no water came to the slope end." in page
    assert "nan" not in page
    assert "](resolved-fig7.png)" not in page


@pytest.mark.minutes
def test_the_page(flume, tmp_path, capsys):
    runs = [str(flume("ueta2022", speed=1.0, grain_speed=0.8)), str(flume("resolved"))]
    with pytest.raises(SystemExit) as done:
        main(["compare", "flume", *reversed(runs), "--out", str(tmp_path / "page")])
    assert done.value.code == 0
    told = capsys.readouterr().out
    line = next(line for line in told.splitlines() if SPEED in line)
    assert [cell.strip() for cell in line.split("|")[3:7]] == ["1", "**missed**", "2", "met"]
    page = (tmp_path / "page" / "comparison.md").read_text()
    for picture in [part.split(")")[0] for part in page.split("](")[1:]]:
        assert (tmp_path / "page" / picture).stat().st_size > 1000
    assert all(f"Fig. {k}" in page for k in (5, 6, 7, 8))
    table = json.loads((tmp_path / "page" / "comparison.json").read_text())
    assert set(table) == {"ueta2022", "resolved"}


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["flum"], "did you mean flume?"),
        (["flume", "one"], "takes two runs, one of each scheme, or none; not 1"),
        (["flume", "a", "b", "--set", "dp=1"], "these runs are made already"),
        (["flume", "--set", "dpp=1"], "dpp"),
    ],
)
def test_mistakes(tmp_path, monkeypatch, capsys, arguments, part):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as caught:
        main(["compare", *arguments])
    assert caught.value.code == 2
    assert part in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_two_runs_of_one_scheme(flume, tmp_path, capsys):
    run = str(flume())
    with pytest.raises(SystemExit) as caught:
        main(["compare", "flume", run, run, "--out", str(tmp_path / "page")])
    assert caught.value.code == 2
    assert "one run of each scheme" in capsys.readouterr().err


def test_a_run_that_is_not_of_the_flume(flow_folder):
    with pytest.raises(UserError, match="not a run of the flume: no window 'outlet'"):
        measure_flume(load(flow_folder))
