"""What `--help` shows of each command, and what its options refuse."""

from __future__ import annotations

import pytest
from typer.main import get_command
from typer.testing import CliRunner

from doseki.cli.app import app

COMMANDS = get_command(app).commands


def shown(*arguments: str) -> str:
    """The help of a command in one line."""
    done = CliRunner().invoke(app, [*arguments, "--help"], env={"COLUMNS": "400", "TERM": "dumb"})
    assert done.exit_code == 0, done.output
    return " ".join(done.output.split())


def test_a_value_that_another_one_replaces_is_named():
    done = CliRunner().invoke(app, ["check", "film", "--set", "dp=1", "--set", "dp = 2"])
    assert "warning: --set dp=1: the later --set dp = 2 counts" in done.output
    once = CliRunner().invoke(app, ["check", "film", "--set", "dp = 2"])
    assert "counts" not in once.output


@pytest.mark.parametrize("name", COMMANDS)
def test_help_loses_none_of_its_words(name):
    """Square brackets would be taken for markup."""
    told = shown(name)
    for parameter in COMMANDS[name].params:
        if parameter.param_type_name == "option" and not parameter.hidden:
            assert " ".join((parameter.help or "").split()) in told
            if isinstance(parameter.show_default, str):
                assert f"({parameter.show_default})" in told


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("run", ["(all cores)", "(runs/NAME)"]),
        ("census", ["(0, where that is in the scene)", "(outlet, else everywhere)"]),
        ("validate", ["(all)", "(runs/validation)"]),
        ("bench", ["(1, 2, all)", "(ueta2022)"]),
        ("check", ["doseki list", "doseki explain"]),
        ("list", ["doseki check"]),
        ("explain", ["doseki check"]),
    ],
)
def test_help_names_defaults_and_neighbours(name, words):
    told = shown(name)
    for word in words:
        assert word in told


@pytest.mark.parametrize(
    "words",
    [["run", "dambreak"], ["study", "a.toml"], ["trust", "dambreak"], ["export", "a", "--vtu"]],
    ids=lambda words: words[0],
)
@pytest.mark.parametrize("name", ["", " "])
def test_an_output_folder_without_a_name_is_refused(monkeypatch, tmp_path, words, name):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, [*words, "-o", name])
    assert done.exit_code == 2
    assert "the name is empty" in done.output
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "film", "--threads", "0"], "0 is outside 1 to 4096"),
        (["run", "film", "--threads", "1.5"], "'1.5' is not a whole number"),
        (["run", "film", "--threads", "9" * 5000], "is outside 1 to 4096"),
        (["resume", "run", "--from", "-1"], "-1 is outside 0 to 1e+12"),
        (["run", "film", "--ranks", "-1"], "-1 is outside 1 to 100000"),
        (["run", "film", "--device", "gpu"], "'gpu' is not one of auto, cpu, host, cuda"),
        (["new", "a.toml", "--dim", "4"], "'4' is not one of 2, 3"),
        (["validate", "--tier", "fine"], "'fine' is not one of coarse, full"),
        (["census", "a", "--draws", "x"], "'x' is not a whole number"),
    ],
)
def test_what_an_option_may_be_is_said_in_our_words(monkeypatch, tmp_path, words, said):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, words, env={"COLUMNS": "400", "TERM": "dumb"})
    assert done.exit_code == 2
    assert f"'{words[-2]}': " in done.output
    assert said in done.output
