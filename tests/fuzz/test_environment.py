"""Whatever the environment, the terminal or the command line says: a sentence and an exit code."""

from __future__ import annotations

import contextlib
import io
import itertools
import os
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from tests.run.channel import doseki_command, environment

from doseki.compiled import load_core
from doseki.errors import UserError
from doseki.util.cores import int_of, shared_cores

from .examples import examples
from .test_command_line import GOOD

VARIABLES = {
    "PMI_SIZE": ["x", "", "-1", "1e3", "9" * 30, "²"],
    "PMI_RANK": ["x", "-1", ""],
    "SLURM_PROCID": ["nan"],
    "DOSEKI_ISA": ["pentium", "../v4"],
    "MPLBACKEND": ["nothing"],
    "PYTHONIOENCODING": ["ascii"],
    "LC_ALL": ["C", "xx_YY"],
    "COLUMNS": ["9223372036854775847", "0", "x", "-5", "²", "9" * 5000],
    "TERM": ["", "土"],
    "HOME": ["/nowhere", ""],
}
CASES = [(name, value) for name, values in VARIABLES.items() for value in values]
SAMPLE = [CASES[k] for k in (0, 4, 6, 9, 11, 12)]


@pytest.fixture
def good(tmp_path):
    """A scenario whose title no narrow encoding has."""
    path = tmp_path / "good.toml"
    path.write_text(f'title = "土石流"\n{GOOD}', encoding="utf-8")
    return path


def assert_clear(done):
    assert done.returncode in (0, 2, 4), (done.returncode, done.stderr)
    assert "Traceback" not in done.stderr
    assert "mistake in doseki" not in done.stderr
    if done.returncode:
        assert [line for line in done.stderr.splitlines() if line.startswith("doseki:")]


def run_with(good, folder, name, value):
    changed = environment() | {name: value}
    return doseki_command("check", good, "--threads", 1, cwd=folder, env=changed)


@pytest.mark.parametrize(("name", "value"), SAMPLE)
def test_a_variable(good, tmp_path, name, value):
    assert_clear(run_with(good, tmp_path, name, value))


@pytest.mark.full
@pytest.mark.parametrize(("name", "value"), CASES)
def test_every_variable(good, tmp_path, name, value):
    assert_clear(run_with(good, tmp_path, name, value))


NAMES = (
    *VARIABLES, "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "SLURM_NTASKS", "PMIX_RANK",
    "OMP_NUM_THREADS", "LINES", "FORCE_COLOR", "NO_COLOR", "TTY_COMPATIBLE", "DOSEKI_DECOMPOSITION",
)  # fmt: skip
NUMBERS = st.one_of(st.integers(), st.floats(), st.integers(0, 4)).map(str)
TEXTS = st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\x00"))


@examples(100, 10_000)
@given(
    variables=st.dictionaries(st.sampled_from(NAMES), NUMBERS | TEXTS, min_size=1, max_size=4),
    words=st.sampled_from([*[("explain", "/nowhere")] * 8, ("list",), ("--help",)]),
)
@example(variables={"COLUMNS": str(2**63)}, words=("--help",))
@example(variables={"COLUMNS": "²", "LINES": "9" * 5000}, words=("--help",))
def test_any_environment(variables, words):
    """What each command reads of it first, in this process."""
    from .test_command_line import run

    said = io.StringIO()
    with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stderr(said):
        with contextlib.redirect_stdout(io.StringIO()):
            for name, value in variables.items():
                patch.setenv(name, value)
            code = run(*words)
        threads = int_of(os.environ.get("OMP_NUM_THREADS"))
        assert threads is None or threads > 0
        shared_cores()
        with contextlib.suppress(UserError):
            load_core(variables.get("DOSEKI_ISA"))
    assert code in (0, 2, 4)
    assert "mistake in doseki" not in said.getvalue()
    assert "Traceback" not in said.getvalue()


@pytest.mark.parametrize("command", ["list", "check"])
def test_output_that_cannot_be_printed(good, tmp_path, command):
    arguments = [command] + ([good, "--threads", 1] if command == "check" else [])
    with Path("/dev/full").open("w") as full:
        done = doseki_command(*arguments, cwd=tmp_path, stdout=full, capture_output=False)
    assert done.returncode == 4


@pytest.mark.parametrize(
    "arguments",
    [
        *itertools.product(["census"], ["."], ["--bin-width", "--from", "--section"], ["nan"]),
        ("census", ".", "--bin-width", "inf"),
        ("resume", ".", "--checkpoint-minutes", "nan"),
        ("plot", "x" * 300),
        ("census", "x" * 300),
        ("explain", "x" * 300),
        ("report", "x" * 300),
        ("report", ".", "--size-mb", "nan"),
        ("run", "x" * 300 + ".toml"),
        ("check", "/proc/self/mem"),
        ("check", "good.toml", "--set", 'body.block.shape="file"'),
    ],
)
def test_arguments(good, tmp_path, monkeypatch, capsys, arguments):
    from .test_command_line import run

    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == 2
    assert "mistake in doseki" not in capsys.readouterr().err


def test_a_movie_whose_name_is_too_long(run_folder, capsys):
    from .test_command_line import run

    assert run("plot", run_folder, "--movie", run_folder / ("x" * 300 + ".gif")) == 2
    assert "File name too long" in capsys.readouterr().err
