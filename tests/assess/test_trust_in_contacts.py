"""The trust report on contacts: overlaps between snapshots count, and contacts give nothing."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.assess.trust.report import trust_checks
from doseki.assess.trust.verdicts import BAD, GOOD, NOT_AVAILABLE
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario

SPEED = 30  # m/s, at which they meet
DISCS = """\
dim = 2
dp = 0.02
time_max = 0.01
time_out = 0.01
scheme = "resolved"
speed_max = 30
gravity = [0, 0]
[contact]
speed = {speed}
[body.flies]
shape = "disc"
material = "basalt"
centre = {centre}
radius = 0.1
velocity = {velocity}
[body.rests]
shape = "disc"
material = "basalt"
centre = [0, 0]
radius = 0.1
"""


def run_of_discs(folder, speed, way):
    """Two discs that meet and part again between the two snapshots of a run."""
    centre, velocity = (-0.3 * np.array(way)).tolist(), (float(SPEED) * np.array(way)).tolist()
    text = DISCS.format(speed=speed, centre=centre, velocity=velocity)
    (folder / "discs.toml").write_text(text, encoding="utf-8")
    run_scenario(load_scenario(str(folder / "discs.toml")), folder / "run")
    return load(folder / "run")


def check_of(run, name):
    return next(check for check in trust_checks(run) if check.name == name)


def overlap_of_contacts(run):
    return check_of(run, "overlap of contacts")


@pytest.mark.parametrize("way", [(1, 0), (0, 1)])
@pytest.mark.parametrize(("speed", "found"), [(1, BAD), (SPEED, GOOD)])
def test_collisions_between_snapshots_count(tmp_path, speed, found, way):
    """Both discs are free of each other in each snapshot."""
    run = run_of_discs(tmp_path, speed, way)
    assert max(snapshot.overlaps().max() for snapshot in run) == 0
    check = overlap_of_contacts(run)
    assert check.verdict == found
    assert check.value == run.summary["largest_overlap"] > 0
    assert "whole run" in check.counted
    if found == BAD:
        assert "raise contact.speed" in check.remedy


def test_a_run_that_is_not_over_has_snapshots_alone(tmp_path):
    """Without a summary, or after the end of that of an earlier end, snapshots alone are seen."""
    run = run_of_discs(tmp_path, 1, (1, 0))
    summary = json.loads(run.folder.summary.read_text(encoding="utf-8"))
    run.folder.summary.write_text(json.dumps(summary | {"time": 0.005}), encoding="utf-8")
    assert "after 0.005 s snapshots alone" in overlap_of_contacts(load(run.directory)).counted
    run.folder.summary.unlink()
    check = overlap_of_contacts(load(run.directory))
    assert check.value == 0
    assert "largest of 2 snapshots alone" in check.counted


def test_contacts_that_give_energy_are_told_of(tmp_path):
    run = run_of_discs(tmp_path, SPEED, (1, 0))
    check = check_of(run, "energy of contacts")
    assert check.verdict == GOOD
    assert check.value < 1e-6
    history = tmp_path / "run" / "history.csv"
    *rows, last = history.read_text(encoding="utf-8").splitlines()
    values = last.split(",")
    given = 0.1 * run.history["kinetic_energy"].max()
    values[rows[0].split(",").index("contact_work")] = f"{given:g}"
    history.write_text("\n".join([*rows, ",".join(values), ""]), encoding="utf-8")
    check = check_of(load(tmp_path / "run"), "energy of contacts")
    assert check.verdict == BAD
    assert "report it" in check.remedy


def test_walls_that_move_may_give_energy(tmp_path):
    moves = "fixed = true\nmotion = { velocity = [-1, 0] }\n[body.beside]"
    text = DISCS.format(speed=SPEED, centre=[-0.3, 0], velocity=[1, 0]) + moves
    text += '\nshape = "disc"\nmaterial = "basalt"\ncentre = [0, 0.4]\nradius = 0.1\n'
    (tmp_path / "moves.toml").write_text(text, encoding="utf-8")
    run_scenario(load_scenario(str(tmp_path / "moves.toml")), tmp_path / "moves")
    check = check_of(load(tmp_path / "moves"), "energy of contacts")
    assert check.verdict == NOT_AVAILABLE
