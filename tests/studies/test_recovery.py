"""Calibration finds the values of a synthetic run again, from its observations with noise."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.studies.study import run_study

HERE = Path(__file__).resolve().parent
NOISE = 0.015  # of each observed number
WITHIN = 0.10  # of the true value


@dataclass(frozen=True)
class Recovery:
    """A scenario, the parameter that is sought in a range, and the gauges that are observed."""

    scenario: str
    key: str
    true: float
    other: float
    low: float
    high: float
    gauges: dict[str, str]  # columns, by gauge


CASES = {
    "roughness": Recovery("film.toml", "ks", 0.0081, 0.013, 0.002, 0.03, {"film": "velocity_x"}),
    "yield stress": Recovery(
        "slump.toml", "tau_y", 270.0, 480.0, 50.0, 1500.0, {"centre": "x", "level": "height"}
    ),
}


def observe(case, true, folder):
    """Observations of a run at `true`: a CSV file for each gauge."""
    scenario = load_scenario(HERE / case.scenario, [f"{case.key}={true}"])
    run_scenario(scenario, folder / "true", RunOptions(threads=1))
    random = np.random.default_rng(7)
    for gauge, column in case.gauges.items():
        record = load(folder / "true").gauges[gauge]
        time, value = record["time"][1:], record[column][1:]
        value = value * (1 + NOISE * random.standard_normal(len(value)))
        error = NOISE * np.abs(value).mean()
        rows = [f"{t},{v},{error}" for t, v in zip(time, value, strict=True)]
        text = "\n".join([f"time [s],{column},error", *rows])
        (folder / f"{gauge}.csv").write_text(text + "\n")


def study_file(case, folder):
    """A study that calibrates the case with the observations in a folder."""
    lines = [
        f'scenario = "{HERE / case.scenario}"',
        'keep = "results"',
        f'[vary.{case.key}]\nmin = {case.low}\nmax = {case.high}\nscale = "log"',
        '[calibrate]\nmethod = "differential_evolution"\nmax_runs = 40',
    ]
    for gauge, column in case.gauges.items():
        lines.append(f'[observation.{gauge}]\nkind = "series"\nfile = "{gauge}.csv"')
        lines.append(f'gauge = "{gauge}"\ncolumn = "{column}"')
    path = folder / "study.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def recovered(case, true, folder):
    """The value that a calibration finds, and its score."""
    folder.mkdir()
    observe(case, true, folder)
    path = study_file(case, folder)
    report = run_study(path, folder / "out", lambda _: None)
    found = json.loads((folder / "out" / "calibration.json").read_text())
    assert found["values"] == {case.key: report.calibration.point[0]}
    print(f"{case.key}: true {true}, found {found['values'][case.key]}, score {found['score']:.3g}")
    return found["values"][case.key], found["score"]


@pytest.mark.full
@pytest.mark.parametrize("name", CASES)
def test_a_value_is_found_again(name, tmp_path):
    case = CASES[name]
    found, score = recovered(case, case.true, tmp_path / "one")
    assert found == pytest.approx(case.true, rel=WITHIN)
    assert 0.5 < score < 1.5  # the noise, and nothing else
    # The control: of another truth the same study finds that one.
    other, _ = recovered(case, case.other, tmp_path / "other")
    assert other == pytest.approx(case.other, rel=WITHIN)
    assert other != pytest.approx(case.true, rel=2 * WITHIN)
