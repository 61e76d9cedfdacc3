"""Studies that are run: their rows, and how one goes on after whatever ended it."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest

from doseki.cli.main import main
from doseki.errors import UserError
from doseki.studies.outcome import pictures
from doseki.studies.outcome.pictures import Pictures
from doseki.studies.outcome.table import Entry, Table
from doseki.studies.plan.file import read_plan
from doseki.studies.runs.folder import StudyFolder, StudyRuns
from doseki.studies.runs.row import DONE, FAILED, LOST, Row, read_row, write_row
from doseki.studies.study import check_study, run_study

from .small_study import SCENARIO, STUDY, write_study

OBSERVED = """
[observation.speed]
kind = "value"
result = "speed"
value = -0.2
error = 0.01
"""


def run(path, folder, **options):
    """The report of a study, and what it said."""
    said = []
    return run_study(path, folder, said.append, **options), said


def table(folder):
    """The rows of results.csv."""
    with (folder / "results.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.minutes
def test_each_run_has_a_row_and_what_is_there_is_not_run_again(tmp_path):
    path, out = write_study(tmp_path, STUDY + OBSERVED), tmp_path / "out"
    report, _ = run(path, out)
    assert report.made == 3
    rows = table(out)
    assert [float(row["pull [m/s2]"]) for row in rows] == [5, 10, 20]
    for row in rows:
        speed = -float(row["pull [m/s2]"]) * 0.02  # of a free fall
        assert float(row["speed [m/s]"]) == pytest.approx(speed, rel=1e-9)
        assert float(row["score"]) == pytest.approx(abs(speed + 0.2) / 0.01, abs=1e-9)
    assert report.table.best().point == (10,)
    about = json.loads((out / "results.json").read_text())
    assert about["values"] == {"pull": {"unit": "m/s2"}}
    assert about["results"] == {"speed": {"unit": "m/s"}}
    assert {file.name for file in (out / "figures").iterdir()} == {"parallel.png", "responses.png"}
    rows_before = {p: p.stat().st_mtime_ns for p in out.glob("runs/*/row.json")}
    again, _ = run(path, out, pictures=False)
    assert again.made == 0
    assert {p: p.stat().st_mtime_ns for p in out.glob("runs/*/row.json")} == rows_before
    # One that is lost is made again, and no other.
    lost = sorted(rows_before)[1]
    lost.unlink()
    assert run(path, out, pictures=False)[0].made == 1


@pytest.mark.minutes
def test_a_study_with_an_odd_title_ends_with_its_pictures(tmp_path, recwarn):
    title = 'title = "Cost $\\\\frac{ of $ it"\n'
    report, _ = run(write_study(tmp_path, title + STUDY), tmp_path / "out")
    assert report.notes == []
    assert {"parallel.png", "responses.png"} <= {file.name for file in report.files}
    assert not recwarn.list


def test_a_picture_that_fails_costs_a_study_no_other(tmp_path, monkeypatch):
    def fail(*_):
        raise ValueError("no ink")

    monkeypatch.setattr(pictures, "parallel_coordinates", fail)
    plan = read_plan(write_study(tmp_path))
    place = SimpleNamespace(path=tmp_path / "1", number=1)
    row = Row(DONE, "", results={"speed": 1.0})
    drawn = Pictures(Table(plan, [Entry(place, (value,), row) for value in (5, 10)]), tmp_path)
    drawn.draw()
    assert [file.name for file in drawn.files] == ["responses.png"]
    assert drawn.notes == ["figure parallel could not be drawn: ValueError('no ink')"]
    assert pictures.outputs_of(drawn._table)[0].label == "speed (m/s)"


@pytest.mark.minutes
def test_a_run_that_fails_is_a_row(tmp_path):
    # Ends of ranges are tried beforehand, one at a time; what two of them make together is not.
    scenario = SCENARIO.replace("[parameters]", "[parameters]\na = 0.1\nb = 0.1").replace(
        'material = "water"', 'material = "water"\njitter = "= a*b"'
    )
    axis = "min = 0.1\nmax = 0.9\ncount = 2\n"
    text = STUDY.replace("[vary.pull]\nvalues = [5, 10, 20]", f"[vary.a]\n{axis}[vary.b]\n{axis}")
    path, out = write_study(tmp_path, text, scenario), tmp_path / "out"
    _, said = run(path, out, pictures=False)
    rows = table(out)
    assert [row["status"] for row in rows] == [DONE, DONE, DONE, FAILED]
    assert "jitter = 0.81" in rows[-1]["reason"]
    assert any("failed" in line and "jitter" in line for line in said)
    # A failure is known, and made again on request alone.
    assert run(path, out, pictures=False)[0].made == 0
    assert run(path, out, pictures=False, retry=True)[0].made == 1


@pytest.mark.minutes
def test_a_study_that_is_killed_leaves_no_run_behind_and_goes_on(tmp_path):
    """kill -9: its runs end with it, and only what is missing is made."""
    text = STUDY.replace("[sample]", "[vary.time_max]\nvalues = [0.02, 4000]\n[sample]")
    text = text.replace("[5, 10, 20]", "[5]")
    path, out = write_study(tmp_path, text), tmp_path / "out"
    command = [sys.executable, "-m", "doseki.cli.main", "study", str(path), "-o", str(out)]
    process = subprocess.Popen([*command, "--at-once", "2"], stderr=subprocess.DEVNULL)
    try:
        wait_for(lambda: list(out.glob("runs/0000*/row.json")))
        wait_for(lambda: list(out.glob("runs/0001*/run/snapshots/000001*")))
        assert processes_in(out)
        os.kill(process.pid, signal.SIGKILL)
    finally:
        process.kill()
        process.wait()
    wait_for(lambda: not processes_in(out))
    assert not list(out.glob("runs/0001*/row.json"))
    done = next(out.glob("runs/0000*/row.json"))
    before = done.stat().st_mtime_ns
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    try:
        wait_for(lambda: processes_in(out))
        (out / "STOP").touch()  # lets what goes on end
        # The run that was under way goes on from the checkpoint that it wrote when it was ended.
        wait_for(lambda: sessions(out) > 1)
        assert processes_in(out)
    finally:
        process.kill()
        process.wait()
    wait_for(lambda: not processes_in(out))
    assert done.stat().st_mtime_ns == before


def sessions(out):
    """How often the second run was begun or gone on with."""
    told = json.loads(next(out.glob("runs/0001*/run/provenance.json")).read_text())
    return len(told["runs"])


def processes_in(out):
    """Processes of runs of a study."""
    found = []
    for process in psutil.process_iter(["cmdline"]):
        words = process.info["cmdline"] or []
        if "doseki.studies.runs.one_run" in words and str(out) in words:
            found.append(process)
    return found


def wait_for(condition, most=600.0):
    """Until something is so; no matter how fast the machine is."""
    end = time.monotonic() + most
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[5, 10, 20]", "[5, 10, 21]", "[vary] has changed"),
        ("[sample]", "[set]\ntime_max = 0.01\n[sample]", "[set] has changed"),
        (None, None, "the scenario has changed"),
    ],
)
def test_runs_of_another_study_are_not_mixed(old, new, words, tmp_path, monkeypatch):
    path, out = write_study(tmp_path), tmp_path / "out"
    make_rows(path, out, monkeypatch)
    if old is None:
        write_study(tmp_path, scenario=SCENARIO.replace("0.3]", "0.4]"))
    else:
        write_study(tmp_path, STUDY.replace(old, new))
    before = {p: p.read_bytes() for p in out.rglob("*") if p.is_file()}
    with pytest.raises(UserError, match="give another folder") as caught:
        run(path, out)
    assert words in str(caught.value)
    assert {p: p.read_bytes() for p in out.rglob("*") if p.is_file()} == before


@pytest.mark.parametrize("shift", ["elsewhere", "absolute", "moved"])
def test_a_study_goes_on_from_another_folder(shift, tmp_path, monkeypatch):
    home, out = tmp_path / "home", tmp_path / "out"
    home.mkdir()
    write_study(home)
    monkeypatch.chdir(home)
    assert make_rows(Path("study.toml"), out, monkeypatch).made == 3
    monkeypatch.chdir(tmp_path)
    path = {"elsewhere": Path("home/study.toml"), "absolute": home / "study.toml"}.get(shift)
    if path is None:
        home.rename(tmp_path / "away")
        path = Path("away/study.toml")
    runs = StudyRuns(StudyFolder(out), read_plan(path))
    assert all(runs.row(runs.place(point)) for point in runs.plan.points())
    assert len(runs) == 3


def make_rows(path, out, monkeypatch, status=DONE):
    """A study whose runs cost nothing: rows are written in place of them."""

    def carry_out(self, places, finished):
        for place in places:
            speed = -float(json.loads(place.job.read_text())["values"][0])
            reading = json.loads((out / "plan.json").read_text())["reading"]
            write_row(place.row, Row(status, reading, "", {"speed": speed}))
            finished(place, "")

    monkeypatch.setattr("doseki.studies.runs.local.LocalRuns.carry_out", carry_out)
    return run_study(path, out, lambda _: None, pictures=False)


def test_more_points_of_a_sequence_are_added(tmp_path, monkeypatch):
    text = STUDY.replace("values = [5, 10, 20]", "min = 5\nmax = 20")
    few, more = (text.replace('"grid"', f'"sobol"\ncount = {n}') for n in (4, 8))
    path, out = write_study(tmp_path, few), tmp_path / "out"
    assert make_rows(path, out, monkeypatch).made == 4
    write_study(tmp_path, more)
    assert make_rows(path, out, monkeypatch).made == 4
    assert len(table(out)) == 8
    write_study(tmp_path, few)
    with pytest.raises(UserError, match="its points are others"):
        make_rows(path, out, monkeypatch)


def test_runs_whose_records_are_gone_are_not_read_anew(tmp_path, monkeypatch):
    for keep, refused in (("results", True), ("all", False)):
        folder = tmp_path / keep
        folder.mkdir()
        text = STUDY.replace("[vary", f'keep = "{keep}"\n[vary')
        path, out = write_study(folder, text), folder / "out"
        make_rows(path, out, monkeypatch)
        write_study(folder, text + 'take = "mean"\n')
        if refused:
            with pytest.raises(UserError, match="their records are gone"):
                make_rows(path, out, monkeypatch)
        else:
            assert make_rows(path, out, monkeypatch).made == 3


def test_what_was_lost_is_made_again(tmp_path, monkeypatch):
    path, out = write_study(tmp_path), tmp_path / "out"
    make_rows(path, out, monkeypatch, LOST)
    assert {row["status"] for row in table(out)} == {LOST}
    assert make_rows(path, out, monkeypatch).made == 3
    assert {row["status"] for row in table(out)} == {DONE}


def test_a_folder_of_others_is_left_alone(tmp_path, monkeypatch, capsys):
    path, out = write_study(tmp_path), tmp_path / "out"
    out.mkdir()
    (out / "letter.txt").write_text("dear")
    with pytest.raises(SystemExit) as ended:
        main(["study", str(path), "-o", str(out)])
    assert ended.value.code == 2
    assert "not the folder of a study" in capsys.readouterr().err
    assert [file.name for file in out.iterdir()] == ["letter.txt"]


def test_links_are_not_followed(tmp_path, monkeypatch):
    path, out = write_study(tmp_path), tmp_path / "out"
    make_rows(path, out, monkeypatch)
    elsewhere = tmp_path / "elsewhere"
    (out / "runs").rename(elsewhere)
    (out / "runs").symlink_to(elsewhere)
    with pytest.raises(UserError, match="symbolic link"):
        make_rows(path, out, monkeypatch)


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "null", '{"status": "done"}', "1" * 5000,
     '{"status": "odd", "reading": "", "reason": "", "trust": "", "results": {}, "misfits": {},'
     ' "score": 1, "seconds": 1}',
     '{"status": "done", "reading": "", "reason": "", "trust": "", "results": {"a": "b"},'
     ' "misfits": {}, "score": 1, "seconds": 1}',
     *('{"status": "done", "reading": "", "reason": "", "trust": "", "results": {},'
       f' "misfits": {odd}, "score": 1, "seconds": 1}}' for odd in ("null", "[]", '"x"', "1")),
     '{"status": "done", "reading": "", "reason": "", "trust": "", "results": {"a": 1e999},'
     ' "misfits": {}, "score": 1, "seconds": 1}'],
)  # fmt: skip
def test_a_damaged_row_is_none(text, tmp_path):
    (tmp_path / "row.json").write_text(text)
    assert read_row(tmp_path / "row.json") is None


def test_a_damaged_plan_is_refused(tmp_path, monkeypatch):
    path, out = write_study(tmp_path), tmp_path / "out"
    make_rows(path, out, monkeypatch)
    (out / "plan.json").write_text("[1]")
    with pytest.raises(UserError, match="damaged"):
        make_rows(path, out, monkeypatch)


def test_a_study_is_estimated_beforehand(tmp_path):
    said = check_study(write_study(tmp_path), at_once=2)
    assert "grid, 3 runs" in said
    assert "2 at once" in said
    assert not (tmp_path / "out").exists()


def test_a_table_goes_to_parquet(tmp_path, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet")
    path = write_study(tmp_path, STUDY.replace("[vary", "parquet = true\n[vary", 1))
    make_rows(path, tmp_path / "out", monkeypatch)
    found = parquet.read_table(tmp_path / "out" / "results.parquet").to_pydict()
    assert found["pull [m/s2]"] == [5.0, 10.0, 20.0]
    assert found["speed [m/s]"] == [-5.0, -10.0, -20.0]


def test_without_pyarrow_one_sentence_says_what_helps(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    path = write_study(tmp_path, STUDY.replace("[vary", "parquet = true\n[vary", 1))
    with pytest.raises(UserError, match=r"pip install 'doseki\[parquet\]'"):
        run(path, tmp_path / "out")
    assert not (tmp_path / "out").exists()
