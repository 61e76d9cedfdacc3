"""Folders that are broken or hostile: one sentence, and no report."""

from __future__ import annotations

import os

import pytest
from tests.hostile_hdf5 import HARMS, spoil

from doseki.cli.main import main


def refused(capsys, folder):
    """The one sentence that the command says."""
    with pytest.raises(SystemExit) as ended:
        main(["report", str(folder)])
    said = capsys.readouterr()
    assert ended.value.code == 2, said
    assert said.out == ""
    assert said.err.startswith("doseki: ")
    assert said.err.count("\n") == 1
    assert "mistake in doseki" not in said.err
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
        ("scenario.toml", "dim = 2\n"),
        ("scenario.toml", "dim = 'two'\ntime_max = 1\ndp = 1\n"),
        ("scenario.toml", "dim = 2\ntime_max = 1\ndp = 1\ngravity = 'down'\n"),
        ("snapshots/000001.vtkhdf", "nothing"),
        ("snapshots/000000.vtkhdf", ""),
    ],
)
def test_a_damaged_file(flow_folder, capsys, file, text):
    (flow_folder / file).write_text(text, encoding="latin-1")
    refused(capsys, flow_folder)


@pytest.mark.parametrize("harm", HARMS)
def test_a_hostile_snapshot(run_folder, capsys, harm):
    spoil(run_folder / "snapshots" / "000001.vtkhdf", "VTKHDF/PointData/Pressure", harm)
    refused(capsys, run_folder)


def test_an_absurd_scenario_of_figures(flow_folder, capsys):
    with (flow_folder / "scenario.toml").open("a") as file:
        file.write('\n[gauge.x]\nkind = "thermometer"\n')
    assert "gauge.x" in refused(capsys, flow_folder)


def test_nothing_is_written_through_a_link(run_folder, tmp_path, capsys):
    outside = tmp_path / "outside"
    (run_folder / "report.html").symlink_to(outside)
    assert "symbolic link" in refused(capsys, run_folder)
    assert not outside.exists()


@pytest.mark.parametrize("size", ["0", "-1", "nan", "1e9", "much"])
def test_an_impossible_size(run_folder, capsys, size):
    with pytest.raises(SystemExit) as ended:
        main(["report", str(run_folder), "--size-mb", size])
    assert ended.value.code == 2
    assert "size-mb" in capsys.readouterr().err


def test_pipes_and_devices_among_pictures_and_tables(flow_folder, capsys):
    """They are left out, and said to be."""
    (flow_folder / "maps").mkdir()
    os.mkfifo(flow_folder / "maps" / "pipe.png")
    os.mkfifo(flow_folder / "loads.csv")
    (flow_folder / "sections.json").write_text("[" * 100000)
    with pytest.raises(SystemExit) as ended:
        main(["report", str(flow_folder)])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    for name in ("pipe.png", "loads.csv", "sections.json"):
        assert f"{name} is left out" in said
