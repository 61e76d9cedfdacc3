"""Scenarios to begin with run as they are written."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.particles import FIXED
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario
from doseki.scenario.start import start_text, write_start
from doseki.scene.build import build_bodies

KINDS = pytest.mark.parametrize("dry", [False, True], ids=["wet", "dry"])


@KINDS
@pytest.mark.parametrize("dim", [2, 3])
def test_a_new_scenario_runs(tmp_path, dim, dry):
    file = tmp_path / "mine.toml"
    write_start(file, dim, dry)
    short = ["time_max=0.002", "time_out=0.001"]
    scenario = load_scenario(str(file), short)
    assert scenario.dim == dim
    summary = run_scenario(scenario, tmp_path / "run")
    assert summary["time"] == pytest.approx(0.002)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_floor_under_dry_grains_is_a_small_part_of_the_work(tmp_path, dim):
    file = tmp_path / "mine.toml"
    write_start(file, dim, dry=True)
    particles, _ = build_bodies(load_scenario(str(file)))
    assert np.sum(particles.motion == FIXED) < 5000
    assert np.sum(particles.motion != FIXED) >= 200


@KINDS
def test_it_says_what_its_keys_mean_and_holds_one_dimension_only(dry):
    for dim in (2, 3):
        text = start_text(dim, dry)
        assert text.count("\ndim = ") == 1
        assert "d2" not in text
        assert sum("#" in line for line in text.splitlines()) > 8


def test_nothing_is_overwritten(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("precious")
    with pytest.raises(UserError, match="exists"):
        write_start(file, 2, dry=False)
    assert file.read_text() == "precious"


@pytest.mark.parametrize(
    ("name", "words"), [("mine.txt", "ends in .toml"), ("no/x.toml", "folder")]
)
def test_what_cannot_be_a_scenario_is_refused(tmp_path, name, words):
    with pytest.raises(UserError, match=words):
        write_start(tmp_path / name, 2, dry=False)
    assert not list(tmp_path.iterdir())
