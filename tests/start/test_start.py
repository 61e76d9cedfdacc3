"""A run that starts from another one: what carries over, what is added, what is refused."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from doseki.driver.checkpoint import CheckpointFolder
from doseki.errors import UserError
from doseki.record.particles import DRIVEN, FREE
from doseki.record.reader import load
from doseki.running.resume import resume_run
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, filled_simulation

from ..run.channel import assert_same_record, channel_text
from .tank import box, continued, disc, run, tank_text

FIELDS = ("position", "velocity", "mass", "density", "smoothing_length", "deviatoric_stress")
TANK = tank_text()


def rows(values):
    """Rows of numbers, one for each particle, in an order that no numbering changes."""
    flat = np.round(np.asarray(values, float).reshape(len(values), -1), 9)
    return flat[np.lexsort(flat.T)]


def assert_same_particles(one, other):
    """Two states hold the same particles of each body, whatever their numbers and the order."""
    for name in ("material", "motion", "body"):
        assert sorted(one[name]) == sorted(other[name])
    for key in FIELDS:
        together = [
            rows(np.column_stack([s["position"], s[key].reshape(len(s[key]), -1)]))
            for s in (one, other)
        ]
        scale = np.abs(together[1]).max(axis=0) + 1e-12
        assert np.abs((together[0] - together[1]) / scale).max() < 1e-8, key


def test_a_checkpoint_goes_on_to_the_same_bits(tmp_path):
    whole = run(TANK, tmp_path / "whole.toml")
    run(TANK, tmp_path / "half.toml", "time_max=0.02")
    rest = run(continued(TANK, "half"), tmp_path / "rest.toml", "time_out=0.005", "title=rest")
    assert rest.times == pytest.approx([0.02, 0.025, 0.03])
    # Outputs at other times end other steps.
    again = run(continued(TANK, "half"), tmp_path / "again.toml")
    for key in (*FIELDS, "pressure", "id"):
        assert np.array_equal(again[-1][key], whole[-1][key]), key
        assert np.array_equal(rest[0][key], again[0][key]), key
    for key, values in whole[-1].grains.items():
        assert np.array_equal(again[-1].grains[key], values), key
    assert again.history["mass_initial"][-1] == whole.history["mass_initial"][-1]


@pytest.mark.parametrize(
    "key", ["body.floor.wall=free_slip", "material.water.nu=0.1", "gravity=[0, -5]"]
)
def test_another_parameter_acts_at_once_on_the_same_state(tank, later, tmp_path, key):
    same, other = (
        run_scenario(load_scenario(later(), keys), tmp_path / name, RunOptions(threads=1))
        and load(tmp_path / name)
        for name, keys in (("same", ()), ("other", (key,)))
    )
    assert np.array_equal(same[0]["velocity"], other[0]["velocity"])
    moved = np.abs(same[-1]["velocity"] - other[-1]["velocity"]).max()
    assert 1e-4 < moved < 1


def test_a_snapshot_gives_the_same_particles_and_bodies(tank, later, tmp_path):
    for time in (0.0, 0.01, 0.02):
        file = later(f"time = {time}")
        names = filled_simulation(load_scenario(file)).body_names
        simulation, _ = build_simulation(load_scenario(file))
        assert simulation.time == tank.at(time).time
        state, before = simulation.state(), tank.at(time)
        state |= {
            key: np.array(names if key == "body" else tank[0].material_names)[state[key]]
            for key in ("body", "material")
        }
        assert_same_particles(state, before)
        grains = simulation.grains()
        moving = ~grains["fixed"]
        for key, values in before.grains.items():
            now = {"position": "centre"}.get(key, key)
            if key in ("position", "velocity", "spin", "orientation", "mass"):
                assert np.allclose(grains[now][moving], values, rtol=0, atol=1e-12), key


def test_walls_face_as_they_have_turned(tank, later):
    """Normals and depths are not in the snapshot; a checkpoint has them."""
    checkpoint, _ = CheckpointFolder(tank.folder.checkpoints).read_last()
    now = build_simulation(load_scenario(later()))[0].checkpoint()
    turned = {}
    for state in (now, checkpoint.state):
        wall = state["motion"] == 1
        columns = [
            state[key][wall].reshape(wall.sum(), -1) for key in ("position", "normal", "wall_depth")
        ]
        turned[len(turned)] = rows(np.column_stack(columns))
    assert np.allclose(turned[0], turned[1], rtol=0, atol=1e-8)
    # The paddle has turned by 0.24 and the gate is gone.
    assert np.abs(np.abs(turned[0][:, 2]) - np.sin(0.24)).min() < 1e-6
    assert turned[0][:, 0].max() < 0.7


@pytest.mark.parametrize(
    ("dim", "precision"),
    [(2, "double"), (2, "mixed"), pytest.param(3, "double", marks=pytest.mark.minutes)],
)
def test_strength_inflows_and_outflows_carry_over(tmp_path, dim, precision):
    text = channel_text(dim, precision)
    first = run(text, tmp_path / "first.toml", "time_max=0.042")
    file = tmp_path / "second.toml"
    file.write_text(continued(text, "first", "time = 0.028"))
    simulation, names = build_simulation(load_scenario(file))
    state, before = simulation.state(), first.at(0.028)
    assert (before["motion"] == DRIVEN).sum() > 0
    free = state["motion"] != DRIVEN
    kept = before["motion"] != DRIVEN
    words = {"body": np.array(names), "material": np.array(before.material_names)}
    mine = {k: v[free] for k, v in state.items()} | {k: w[state[k]][free] for k, w in words.items()}
    theirs = {k: before[k][kept] for k in (*FIELDS, "motion", *words)}
    assert_same_particles(mine, theirs)
    # The layers behind the section are those that the inflow has at that time.
    assert np.allclose(
        rows(state["position"][~free]), rows(before["position"][~kept]), rtol=0, atol=1e-9
    )
    # The account begins with what is there, though some of what entered before has left.
    totals = simulation.totals()
    assert totals["mass_initial"] == totals["mass"] > 0
    assert totals["mass_entered"] == totals["mass_asked"] == totals["mass_left"] == 0
    simulation.advance(limit=0.042, pause=0.042, max_steps=10**6)
    later = simulation.totals()
    balance = later["mass_initial"] + later["mass_entered"] - later["mass_left"] - later["mass"]
    assert abs(balance) < 1e-12 * later["mass"]
    # The inflow brings what it brings in a run from the start, and is asked for the same.
    for key in ("mass_entered", "mass_asked"):
        column = first.history[key]
        since = column[-1] - np.interp(0.028, first.history["time"], column)
        assert since > 0
        assert later[key] == pytest.approx(since, rel=1e-9), key


@pytest.mark.parametrize(("films", "most", "off"), [("true", 0.05, 2e-4), ("false", 0.003, 1e-4)])
def test_it_is_near_the_run_that_went_on(tmp_path, films, most, off):
    """A snapshot has no rates, averages, springs or sudden forces: later states differ a little.

    Nor has it the pressure of the film below the soft block, which is at rest at the start.
    """
    text = TANK.replace("speed_max = 2\n", f"speed_max = 2\nuplift = {films}\n")
    went = run(text, tmp_path / "tank.toml")
    file = tmp_path / "later.toml"
    later = text.replace("time_max = 0.03", "time_max = 0.05")
    file.write_text(continued(later, went.directory, "time = 0.02"))
    simulation, _ = build_simulation(load_scenario(file))
    simulation.advance(limit=0.03, pause=0.03, max_steps=10**6)
    state, went_on = simulation.state(), went.at(0.03)
    free = state["motion"] == FREE
    assert free.sum() == (went_on["motion"] == FREE).sum()
    apart = state["velocity"][free] - went_on["velocity"][went_on["motion"] == FREE]
    scale = went_on["velocity"][went_on["motion"] == FREE]
    assert np.sqrt((apart**2).sum() / (scale**2).sum()) < most
    grains = simulation.grains()
    centre = grains["centre"][~grains["fixed"]]
    assert np.abs(centre - went_on.grains["position"]).max() < off


def test_it_is_mirrored_with_the_scene(tank, tmp_path):
    run(tank_text(-1), tmp_path / "mirrored.toml")
    states = []
    for side, folder in ((1, tank.directory), (-1, tmp_path / "mirrored")):
        file = tmp_path / f"side{side}.toml"
        text = tank_text(side) + disc("three", 0.1, side, 0.3)
        text = text.replace("time_max = 0.03", "time_max = 0.05")
        file.write_text(continued(text, folder, "time = 0.02"))
        simulation, _ = build_simulation(load_scenario(file))
        simulation.advance(limit=0.021, pause=0.021, max_steps=10**6)
        states.append(simulation.state())
    sides = [
        rows(np.hstack([s["position"] * [sign, 1], s["velocity"] * [sign, 1]]))
        for sign, s in zip((1, -1), states, strict=True)
    ]
    assert np.abs(sides[0] - sides[1]).max() < 1e-6


def test_added_bodies_make_room(tank, later):
    """A stone, a pier, and an elastic plate in the water that is there; those before stay."""
    text = TANK + disc("stone", 0.08, y=0.05) + box("pier", (0.14, 0), (0.2, 0.2), "fixed = true")
    simulation, names = build_simulation(load_scenario(later("time = 0.02", text=text)))
    state, before = simulation.state(), tank.at(0.02)
    water = state["position"][(state["motion"] == FREE)]
    apart = np.linalg.norm(water - [0.08, 0.05], axis=1)
    assert apart.min() > 0.04 * 0.999
    inside = (water > [0.14, 0]).all(axis=1) & (water < [0.2, 0.2]).all(axis=1)
    assert not inside.any()
    gone = (before["motion"] == FREE).sum() - len(water)
    assert gone > 15
    # What remains is where it was.
    known = {tuple(x) for x in np.round(before["position"], 12)}
    assert all(tuple(x) in known for x in np.round(water, 12))
    simulation.advance(limit=0.025, pause=0.025, max_steps=10**6)
    assert names.index("pier") in simulation.state()["body"]


def test_grains_that_have_left_stay_away_in_runs_of_runs(tank, later, tmp_path):
    """A run from a run: its own additions carry over, what has left does not come back."""
    text = TANK + "[outflow.end]\nmin = [0.4, -1]\nmax = [9, 1]\n" + disc("three", 0.1, y=0.3)
    second = run(
        continued(text.replace("time_max = 0.03", "time_max = 0.04"), tank.directory),
        tmp_path / "second.toml",
    )
    assert second[-1].grains["removed"].sum() == 1
    third = run(
        continued(text.replace("time_max = 0.03", "time_max = 0.05"), "second", "time = 0.04"),
        tmp_path / "third.toml",
        "contact.steps=30",
    )
    shutil.rmtree(tmp_path / "second" / "checkpoints")
    file = tmp_path / "fourth.toml"
    file.write_text(continued(text.replace("time_max = 0.03", "time_max = 0.05"), "second"))
    grains = build_simulation(load_scenario(file))[0].grains()
    moving = ~grains["fixed"]
    assert set(third[0].grains["body"][third[0].grains["removed"] == 0]) == {"one", "three"}
    assert moving.sum() == 2
    assert np.allclose(
        grains["centre"][moving],
        second[-1].grains["position"][second[-1].grains["removed"] == 0],
        atol=1e-14,
    )


def test_it_needs_the_earlier_run_no_more(tank, tmp_path):
    shutil.copytree(tank.directory, tmp_path / "given")
    text = (TANK + disc("three", 0.1, y=0.3)).replace("time_max = 0.03", "time_max = 0.05")
    straight = run(continued(text, "given"), tmp_path / "straight.toml")
    stopped = tmp_path / "stopped"
    options = RunOptions(
        threads=1, progress=lambda time, *_: (stopped / "STOP").touch() if time > 0.035 else None
    )
    run_scenario(load_scenario(tmp_path / "straight.toml"), stopped, options)
    shutil.rmtree(tmp_path / "given")
    assert len(list((stopped / "inputs").iterdir())) == 3
    assert str(tmp_path) not in (stopped / "scenario.toml").read_text()
    shutil.copytree(stopped, tmp_path / "anew")
    resume_run(stopped, (), RunOptions(threads=1))
    assert_same_record(stopped, straight.directory)
    for file in [*(tmp_path / "anew/checkpoints").iterdir(), tmp_path / "anew/summary.json"]:
        file.unlink()
    resume_run(tmp_path / "anew", (), RunOptions(threads=1))
    assert_same_record(tmp_path / "anew", straight.directory)
    # And the copies are known.
    copy = next((stopped / "inputs").glob("*.vtkhdf"))
    copy.write_bytes(copy.read_bytes()[:-1] + b"x")
    with pytest.raises(UserError, match=r"start\.from: .* is not the file that was meant"):
        load_scenario(stopped / "scenario.toml")


def test_the_nearest_snapshot_is_named(later):
    _, _, warnings = filled_simulation(load_scenario(later("time = 0.0123")))
    assert any(
        "0.0123 s lies between two snapshots; the one at 0.01 s is taken" in str(w)
        for w in warnings
    )
    _, _, warnings = filled_simulation(load_scenario(later("time = 0.02")))
    assert not any("between" in str(w) for w in warnings)


def test_bodies_can_be_left_out(tank, later):
    file = later("without = ['two', 'block']", text=without(TANK, "two", "block"))
    simulation, names = build_simulation(load_scenario(file))
    assert "two" not in names
    assert (~simulation.grains()["fixed"]).sum() == 1


def without(text, *names):
    """The scenario without some bodies."""
    head, *tables = text.split("[body.")
    return head + "".join(f"[body.{t}" for t in tables if t.partition("]")[0] not in names)
