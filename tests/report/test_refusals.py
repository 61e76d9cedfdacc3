"""Folders that are broken or hostile: one sentence, and no report."""

from __future__ import annotations

import os

import h5py
import pytest
from tests.hostile_hdf5 import HARMS, spoil

from doseki.cli.main import main
from doseki.util.sealed import sealed


def refused(capsys, folder):
    """The one sentence that the command says."""
    with pytest.raises(SystemExit) as ended:
        main(["report", str(folder)])
    said = capsys.readouterr()
    assert ended.value.code == 2, said
    assert said.out == ""
    assert said.err.startswith("doseki: ")
    assert said.err.count("\n") == 1
    for words in ("mistake in doseki", "object", "indices", "attribute", "NoneType"):
        assert words not in said.err
    assert not (folder / "report.html").is_file()
    return said.err


def test_no_run(tmp_path, capsys):
    assert "not the folder of a run" in refused(capsys, tmp_path)
    assert "no such folder" in refused(capsys, tmp_path / "nothing")


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("history.csv", "time\n1\n"),
        ("history.csv", "time,step\n1\n"),
        ("history.csv", "\x00\xff"),
        ("summary.json", "[]"),
        ("summary.json", "{"),
        ("summary.json", '{"wall_seconds": "long", "mass_initial": []}'),
        ("trust.json", '{"checks": 5}'),
        ("trust.json", '{"checks": [{"name": 1}]}'),
        ("trust.json", "[1]"),
        ("failure.json", "nothing"),
        ("provenance.json", '{"runs": 3}'),
        ("provenance.json", '"x"'),
        ("summary.json", "5"),
        ("summary.json", '{"status": "done", "runout": [1]}'),
        ("scenario.toml", "dim = 2\n"),
        ("scenario.toml", "dim = 'two'\ntime_max = 1\ndp = 1\n"),
        ("scenario.toml", "dim = 2\ntime_max = 1\ndp = 1\ngravity = 'down'\n"),
        ("snapshots/000001.vtkhdf", "nothing"),
        ("snapshots/000000.vtkhdf", ""),
    ],
)
def test_a_damaged_file(drawn_flow, capsys, file, text):
    (drawn_flow / file).write_text(text, encoding="latin-1")
    refused(capsys, drawn_flow)


@pytest.mark.parametrize("file", ["summary.json", "provenance.json", "trust.json"])
def test_a_damaged_file_is_told_before_figures_are_drawn(flow_folder, capsys, file):
    (flow_folder / file).write_text("[")
    assert file in refused(capsys, flow_folder)
    assert not (flow_folder / "figures").exists()


def test_a_snapshot_without_its_bodies_is_named(map_run, capsys):
    file = map_run / "snapshots" / "000002.vtkhdf"
    with h5py.File(file, "a") as snapshot:
        del snapshot["Grains"]
    said = refused(capsys, map_run)
    assert f'{file}: "Grains" is missing, the table of the bodies' in said


@pytest.mark.parametrize("harm", HARMS)
def test_a_hostile_snapshot(run_folder, capsys, harm):
    spoil(run_folder / "snapshots" / "000001.vtkhdf", "VTKHDF/PointData/Pressure", harm)
    refused(capsys, run_folder)


def test_an_absurd_scenario_of_figures(drawn_flow, capsys):
    with (drawn_flow / "scenario.toml").open("a") as file:
        file.write('\n[gauge.x]\nkind = "thermometer"\n')
    assert "gauge.x" in refused(capsys, drawn_flow)


@pytest.mark.parametrize("words", [["report"], ["plot"], ["export", "--paraview"]])
def test_a_scenario_that_was_changed_by_hand_is_told_once(drawn_flow, capsys, words):
    file = drawn_flow / "scenario.toml"
    file.write_text(sealed(file.read_text()).replace("dp = ", "# here\ndp = "))
    with pytest.raises(SystemExit):
        main([*words, str(drawn_flow)])
    said = f"{file}: has been changed by hand since the run wrote it"
    assert capsys.readouterr().err.count(f"warning: {said}") == 1
    if words == ["report"]:
        assert said in (drawn_flow / "report.html").read_text()


def test_nothing_is_written_through_a_link(run_folder, tmp_path, capsys):
    outside = tmp_path / "outside"
    (run_folder / "report.html").symlink_to(outside)
    assert "symbolic link" in refused(capsys, run_folder)
    assert not outside.exists()


def test_what_is_no_report_is_not_overwritten(run_folder, tmp_path, capsys):
    (tmp_path / "letter.html").write_text("<html>Dear all</html>")
    with pytest.raises(SystemExit) as ended:
        main(["report", str(run_folder), "-o", str(tmp_path / "letter.html")])
    assert ended.value.code == 2
    assert "no report of doseki" in capsys.readouterr().err
    assert "Dear" in (tmp_path / "letter.html").read_text()
    for _ in range(2):
        with pytest.raises(SystemExit) as ended:
            main(["report", str(run_folder)])
        assert ended.value.code == 0


@pytest.mark.parametrize("size", ["0", "-1", "nan", "1e9", "much"])
def test_an_impossible_size(run_folder, capsys, size):
    with pytest.raises(SystemExit) as ended:
        main(["report", str(run_folder), "--size-mb", size])
    assert ended.value.code == 2
    assert "size-mb" in capsys.readouterr().err


def test_pipes_and_devices_among_pictures_and_tables(drawn_flow, capsys):
    """They are left out, and said to be."""
    (drawn_flow / "maps").mkdir()
    os.mkfifo(drawn_flow / "maps" / "pipe.png")
    os.mkfifo(drawn_flow / "loads.csv")
    (drawn_flow / "sections.json").write_text("[" * 100000)
    with pytest.raises(SystemExit) as ended:
        main(["report", str(drawn_flow)])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    for name in ("pipe.png", "loads.csv", "sections.json"):
        assert f"{name} is left out" in said
