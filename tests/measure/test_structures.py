"""Structures, which are clamped, are no grains; what breaks off them is."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from doseki.cli.main import main
from doseki.measure.census.census import take_census
from doseki.measure.census.grains import grains_of
from doseki.measure.census.lineage import Lineage
from doseki.measure.grading import grading_of, gradings, structure_names
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation

from ..small_scenarios import CHALK

POST = (
    """
schema = 1
dim = 2
dp = 0.01
scheme = "resolved"
speed_max = 20
time_max = 0.012
time_out = 0.012
gravity = [0, 0]

[body.post]
shape = "box"
material = "chalk"
kinematics = "elastic"
min = [0, 0]
max = [0.08, 0.4]
clamped = "= 0.1 - y"

[body.stone]
shape = "disc"
material = "basalt"
centre = [-0.055, 0.3]
radius = 0.05
velocity = [15, 0]
"""
    + CHALK
)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A post that is struck: its top flies off."""
    folder = tmp_path_factory.mktemp("post")
    (folder / "post.toml").write_text(POST, encoding="utf-8")
    run_scenario(load_scenario(str(folder / "post.toml")), folder / "run", RunOptions(threads=1))
    return load(folder / "run")


@pytest.mark.parametrize("height", [0.15, 0.3])
def test_the_clamped_part_stays_the_structure(tmp_path, height):
    """Whichever part is larger."""
    alone = POST[: POST.index("[body.stone]")] + CHALK
    (tmp_path / "post.toml").write_text(alone, encoding="utf-8")
    simulation, _ = build_simulation(load_scenario(str(tmp_path / "post.toml")))
    core = getattr(simulation, "_core", simulation)
    core.cut_bodies(np.ascontiguousarray(simulation.state()["position"][:, 1] > height, np.int32))
    simulation.advance(limit=1.0, pause=1.0, max_steps=1)
    parts = simulation.fragments()
    np.testing.assert_allclose(parts["centre"][:, 1], [height / 2, 0.2 + height / 2], atol=1e-3)
    assert parts["parent"].tolist() == [-1, 0]


def test_it_is_no_grain_and_what_came_off_is(run):
    names = structure_names(run)
    assert names == {"post"}
    first, last = (grains_of(run[k], {"water"}, names) for k in (0, -1))
    assert len(first.mass) == 1  # the stone
    assert last.is_part.sum() == len(last.mass) - 1 > 5
    table = run[-1].grains
    (kept,) = np.flatnonzero((table["body"] == "post") & (table["parent"] < 0))
    there = table["mass"][table["removed"] == 0].sum()
    assert last.mass.sum() == pytest.approx(there - table["mass"][kept], rel=1e-12)
    assert take_census(run).table["mass"].sum() == pytest.approx(last.mass.sum() + first.mass[0])


def test_nor_is_it_in_the_grading(run):
    """The control: without its name it is the largest there."""
    table = run[-1].grains
    (post,) = np.flatnonzero((table["body"] == "post") & (table["parent"] < 0))
    for grading in gradings(run).values():
        assert post not in grading.grain
        assert len(grading.grain) > 0
    assert post in grading_of(run[-1], set()).grain


def test_the_load_is_what_was_loose_at_the_start(run):
    """Parts of the post are many times the stone that breaks them."""
    census = take_census(run)
    stone = run[0].grains["mass"][run[0].grains["body"] == "stone"].sum()
    assert census.load_mass == pytest.approx(stone)
    loose = sum(census.mass_of(kind) for kind in range(6))
    np.testing.assert_allclose(loose, stone)
    table = run[-1].grains
    post = (table["body"] == "post") & (table["parent"] < 0)
    lost = run[0].grains["mass"][run[0].grains["body"] == "post"].sum() - table["mass"][post].sum()
    np.testing.assert_allclose(census.off_structures, [0, lost])


class Made:
    """A snapshot with a table of bodies."""

    def __init__(self, parent):
        self.grains = {"parent": np.array(parent), "body": np.array(["post"] * len(parent))}
        self.grains["body"][1:2] = "stone"


def test_parts_of_parts_are_of_what_their_line_began_with():
    """Row 0 is a post, 1 a stone; in the second snapshot both have lost parts, and these others."""
    lineage = Lineage({"post"})
    assert [x.tolist() for x in lineage.look(Made([-1, -1]), np.array([1]))] == [[True], [-1]]
    parents, ids = [-1, -1, 0, 1, 2, 3, 5], np.array([1, 2, 4, 5, 6])  # 3 is dust
    load, source = lineage.look(Made(parents), ids)
    assert load.tolist() == [True, False, False, True, True]
    assert source.tolist() == [1, -1, -1, 1, 1]
    load, source = lineage.look(Made([*parents, 4, 6]), np.array([1, 2, 7, 8]))
    assert load.tolist() == [True, False, False, True]
    assert source.tolist() == [1, 2, 4, 6]


def test_what_lies_about_when_a_run_begins_is_load():
    """It goes on from one in which a part had come off the post."""
    load, _ = Lineage({"post"}).look(Made([-1, -1, 0]), np.array([1, 2]))
    assert load.tolist() == [True, True]


SHAKEN = (
    POST[: POST.index("[body.stone]")].replace(
        "clamped", 'velocity = ["= max(0, y - 0.1)*150", 0]\nclamped'
    )
    + CHALK
)


@pytest.mark.filterwarnings("error")
def test_where_only_a_structure_breaks_there_is_no_load(tmp_path, capsys):
    (tmp_path / "post.toml").write_text(SHAKEN, encoding="utf-8")
    run_scenario(
        load_scenario(str(tmp_path / "post.toml")), tmp_path / "run", RunOptions(threads=1)
    )
    with pytest.raises(SystemExit) as done:
        main(["census", str(tmp_path / "run"), "--section", "0.1"])
    assert done.value.code == 0
    told = capsys.readouterr()
    assert "no load: nothing was loose at the start" in told.out
    assert "came off structures and is not of the load: " in told.out
    assert "figure classes is not drawn: there is no load" in told.out
    for unwanted in ("nan", "warning", "Error"):
        assert unwanted not in told.out + told.err
    folder = tmp_path / "run" / "census"
    assert (folder / "grading.png").is_file()
    with (folder / "passed.csv").open() as file:
        last = list(csv.DictReader(file))[-1]
    assert float(last["x = 0.1"]) == 0
    assert "x = 0.1 off structures" in last
    with (folder / "grains.csv").open() as file:
        assert {row["origin"] for row in csv.DictReader(file)} == {"structure"}
