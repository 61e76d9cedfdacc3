"""A flow that leaves its map is told of: how much, and where; what an outflow takes is meant."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np
import pytest

from doseki.assess.ground.leaving import leaving_findings, left_text, lost_share
from doseki.assess.trust.ground import ground_check
from doseki.measure.maps.leaving import Left, what_left
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from .scenes import grid, profile, text

SIZE = (6.0, 4.0)
RELEASE = """
[body.debris]
shape = "release"
material = "water"
polygon = [[{x}, 1.5], [{end}, 1.5], [{end}, 2.5], [{x}, 2.5]]
thickness = 0.3
velocity = [3.0, 0.0, 0.0]
"""
OUTFLOW = """
[outflow.end]
min = [5.0, -1.0, -20.0]
max = [9.0, 5.0, 20.0]
"""


def run(folder, x, hole=False, more="", time=0.8):
    """The summary of 0.3 m3 of water that runs to the east, from `x` on."""

    def height(x, y):
        z = -0.3 * x
        beyond = hole & (np.abs(x - 3.5) < 0.3)
        return np.where(beyond, np.nan, z)

    grid(folder / "terrain.asc", height, SIZE)
    path = folder / "case.toml"
    tables = RELEASE.format(x=x, end=x + 1.0) + more
    path.write_text(text(3, dp=0.1, time=time, speed=6.0, more=tables))
    scenario = load_scenario(path, ["time_out=0.2"])
    return run_scenario(scenario, folder / "run", RunOptions(1))


@pytest.mark.parametrize(
    ("x", "hole", "more", "way", "said"),
    [
        (
            4.5,
            False,
            "",
            "edge",
            "% of the mass left over the edge of the map, most by the e",
        ),
        (2.0, True, "", "no_data", "% of the mass vanished into cells without data, around (3."),
        (3.8, False, OUTFLOW, "outflow", None),
    ],
)
def test_where_it_left(tmp_path, x, hole, more, way, said):
    summary = run(tmp_path, x, hole, more)
    left, gone = summary["left"], summary["mass_left"]
    assert gone > 0.2 * summary["mass_initial"]
    assert left[way] > 0.95 * gone
    assert left["edge"] + left["no_data"] + left["outflow"] == pytest.approx(gone)
    doubts = [each for each in summary["warnings"] if "of the mass" in each]
    assert len(doubts) == (said is not None)
    if said is not None:
        share = f"terrain: {100 * left[way] / summary['mass_initial']:.2g} "
        assert doubts[0].startswith(share + said)
        assert "run-out, maps and deposit are without it" in doubts[0]
    (check,) = (c for c in load(tmp_path / "run").trust["checks"] if c["name"] == "left the map")
    assert check["verdict"] == ("good" if said is None else "bad")
    assert check["value"] == pytest.approx(lost_share(summary))
    words = {"edge": "over the edge of the map", "no_data": "into cells without data"}
    text = (tmp_path / "run/summary.txt").read_text()
    assert f"kg {words.get(way, 'through outflows')}" in text


def test_what_stays_on_the_map_is_no_doubt(tmp_path):
    summary = run(tmp_path, 0.5, time=0.3)
    assert summary["mass_left"] == 0
    assert "left" not in summary
    assert not list(leaving_findings(summary))
    (check,) = (c for c in load(tmp_path / "run").trust["checks"] if c["name"] == "left the map")
    assert (check["value"], check["verdict"]) == (0.0, "good")


def test_a_hundredth_of_the_mass_is_told_of():
    said = {"mass_initial": 60.0, "mass_entered": 40.0}
    left = {"edge": 0.9, "no_data": 1.1, "outflow": 50.0, "side": "western", "hole": [3.0, 4.0]}
    left["unseen"] = 0.0
    (doubt,) = map(str, leaving_findings(said | {"left": left}))
    assert "1.1 % of the mass vanished into cells without data, around (3, 4) m" in doubt
    assert lost_share(said | {"left": left}) == pytest.approx(0.02)


def test_what_comes_and_leaves_between_snapshots_is_not_known(tmp_path):
    grid(tmp_path / "terrain.asc", lambda x, y: 0 * x, SIZE)
    path = tmp_path / "case.toml"
    release = RELEASE.format(x=2.0, end=3.0)
    path.write_text(text(3, dp=0.1, time=0.01, speed=6.0, more=release))
    run_scenario(load_scenario(path), tmp_path / "run", RunOptions(1))
    left = what_left(load(tmp_path / "run"), 30.0)
    said = {"mass_initial": 0.0, "mass_entered": 100.0, "left": asdict(left)}
    (doubt,) = map(str, leaving_findings(said))
    assert "30 % of the mass left before a snapshot had it" in doubt
    assert lost_share(said) == pytest.approx(0.3)
    assert left_text(said["left"], 3) == "left 30 kg before a snapshot had it"


@pytest.mark.parametrize(("more", "verdict"), [("", "bad"), (OUTFLOW, "not available")])
def test_what_no_snapshot_had_counts_unless_an_outflow_may_have_taken_it(tmp_path, more, verdict):
    run(tmp_path, 0.5, more=more, time=0.01)
    path = tmp_path / "run/summary.json"
    summary = json.loads(path.read_text())
    left = Left(0.0, 0.0, 0.0, unseen=0.5 * summary["mass_initial"])
    path.write_text(json.dumps(summary | {"left": asdict(left)}))
    _, check = ground_check(load(tmp_path / "run"))
    assert (check.name, check.verdict) == ("left the map", verdict)


def test_a_flow_in_a_plane_leaves_its_profile(tmp_path):
    profile(tmp_path / "terrain.csv", lambda x: -0.3 * x, 0.0, 4.0)
    tables = '[body.debris]\nshape = "release"\nmaterial = "water"\nbetween = [2.8, 3.6]\n'
    tables += "thickness = 0.3\nvelocity = [3.0, 0.0]\n"
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.1, time=0.4, speed=6.0, more=tables))
    summary = run_scenario(load_scenario(path), tmp_path / "run", RunOptions(1))
    assert summary["left"]["edge"] == pytest.approx(summary["mass_left"])
    assert summary["mass_left"] > 0
    assert summary["left"]["side"] == "right"
    assert what_left(load(tmp_path / "run"), 0.0) is None
