"""Wrong input on the command line: code 2, one message, nothing written elsewhere."""

from __future__ import annotations

import pytest

from doseki.cli.main import main

GOOD = """\
schema = 1
dim = 2
dp = 0.01
time_max = 0.0001
time_out = 0.0001
xi = 0.05

[body.block]
shape = "box"
material = "basalt"
min = [0, 0]
max = [0.03, 0.03]
"""
FIGURE = '\n[figure."{name}"]\nkind = "snapshot"\n'


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder to work in, with a good scenario."""
    (tmp_path / "work").mkdir()
    monkeypatch.chdir(tmp_path / "work")
    (tmp_path / "work/good.toml").write_text(GOOD)
    return tmp_path / "work"


def tree(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def run(*arguments):
    """The exit code of a command."""
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as end:
        return end.code or 0
    return 0


def assert_refused(capsys, *arguments):
    """Code 2 and one message on standard error."""
    assert run(*arguments) == 2
    said = capsys.readouterr().err
    assert "Traceback" not in said
    assert len([line for line in said.splitlines() if line.startswith("doseki:")]) == 1


@pytest.mark.parametrize(
    "change",
    [
        ("dp = 0.01", "dp = nan"),
        ("dp = 0.01", "dp = 1e-300"),
        ("dp = 0.01", "dp = -1"),
        ("dp = 0.01", "dp = '= 10**10**10'"),
        ("dim = 2", "dim = 4"),
        ("basalt", "granit"),
        ("schema = 1", "schema = 2"),
        ("min = [0, 0]", "min = [0]"),
        ("schema = 1", "schema = 1\n[" * 99),
        ('"box"', '"file"\nfile = "/dev/zero"'),
        ('"box"', '"file"\nfile = "../nothing.csv"'),
        ("schema = 1", 'schema = 1\nextends = "/dev/stdin"'),
        ("[body.block]", '[body."../../evil"]\n'),
    ],
)
def test_a_wrong_scenario_leaves_nothing_behind(here, capsys, change):
    old, new = change
    (here / "bad.toml").write_text(GOOD.replace(old, new))
    assert_refused(capsys, "run", "bad.toml", "-o", "out")
    assert tree(here) == ["bad.toml", "good.toml"]


@pytest.mark.parametrize(
    "name", ["../../evil", "/tmp/doseki-evil", "..", "a/b", "\\u0000", "x" * 300]
)
def test_names_of_figures_do_not_lead_outside(here, capsys, name):
    (here / "bad.toml").write_text(GOOD + FIGURE.format(name=name))
    before = tree(here.parent)
    assert_refused(capsys, "run", "bad.toml", "-o", "out", "--threads", 1)
    assert tree(here.parent) == before


@pytest.mark.parametrize(
    "link", ["snapshots", "history.csv", "figures", "checkpoints", "scenario.toml"]
)
def test_nothing_is_written_through_a_link(here, capsys, link):
    assert run("run", "good.toml", "-o", "out", "--threads", 1) == 0
    outside = here.parent / "outside"
    target = here / "out" / link
    if target.is_dir():
        target.rename(outside)
    else:
        outside.write_text("mine")
        target.unlink(missing_ok=True)
    target.symlink_to(outside)
    before = {path: path.read_bytes() for path in [outside, *outside.rglob("*")] if path.is_file()}
    for command in (
        ("run", "good.toml", "-o", "out", "--overwrite"),
        ("plot", "out"),
        ("resume", "out"),
    ):
        assert_refused(capsys, *command)
    assert before == {
        path: path.read_bytes() for path in [outside, *outside.rglob("*")] if path.is_file()
    }


def test_debug_shows_the_traceback(here, capsys):
    (here / "bad.toml").write_text("schema = ")
    assert run("--debug", "run", "bad.toml") == 2
    said = capsys.readouterr().err
    assert "Traceback" in said
    assert said.splitlines()[-1].startswith("doseki: ")


def test_a_mistake_of_ours_is_one_line_too(here, capsys, monkeypatch):
    def fail(*_arguments):
        raise ZeroDivisionError("at\nhome")

    monkeypatch.setattr("doseki.scenario.load.load_scenario", fail)
    assert run("run", "good.toml") == 1
    said = capsys.readouterr().err.splitlines()
    assert said == [
        "doseki: a mistake in doseki itself: ZeroDivisionError: at home (--debug shows where)"
    ]
