"""Tiers of the tests: their names and markers, and what continuous integration makes of them."""

from __future__ import annotations

import subprocess
import sys
import tomllib

import pytest

from ..ci import GRACE, WORDS, Outcome, order, report, run_tiers
from ..tiers import APART, ROOT, TIERS, UnknownTierError, pytest_arguments


def test_markers_are_declared():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["pytest"]["ini_options"]
    names = {line.partition(":")[0] for line in declared["markers"]}
    assert names == {"minutes", *APART}
    assert set(APART) < set(TIERS)


def test_options_and_files_are_passed_on():
    words = ["-k", "kernel", "tests/core/physics"]
    assert pytest_arguments(["validate", *words])[-5:] == ["-m", "validate", *words]
    assert pytest_arguments(words)[-3:] == words
    assert pytest_arguments(["tests/ci.py::nothing"])[-1] == "tests/ci.py::nothing"


@pytest.mark.parametrize(("word", "meant"), [("valdate", "validate"), ("fast2", "fast")])
def test_an_unknown_tier_is_refused_with_the_nearest_one(word, meant):
    with pytest.raises(UnknownTierError, match=f'"{word}"; did you mean {meant}[?]'):
        pytest_arguments([word])
    command = [sys.executable, "-m", "tests.tiers", word]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1


def test_every_tier_is_run_and_each_commit_draws_another_order():
    orders = {tuple(order(f"{number:040x}")) for number in range(50)}
    assert len(orders) > 30
    for names in orders:
        assert names[0] == "default"
        assert set(names) == set(WORDS) == {*TIERS} - {"fast"}
    assert {names[1] for names in orders} == set(WORDS) - {"default"}
    assert order("a1") == order("a1")


def test_tiers_are_started_while_there_is_time():
    clock = iter([3600.0, 3000.0, 1000.0, 150.0, 100.0])
    started = []

    def run(name, seconds):
        started.append((name, seconds))
        return Outcome(passed=1)

    outcomes = run_tiers(["default", "fuzz", "isa", "ranks"], run, lambda: next(clock))
    assert started == [("default", 3000.0), ("fuzz", 1000.0)]
    assert outcomes["isa"] is outcomes["ranks"] is None


PRINTED = """\
created: 2/2 workers
2 workers [12 items]

.F.s
FAILED tests/a.py::bad - assert 0
ERROR tests/a.py::worse[1 2]
!!!!!! KeyboardInterrupt !!!!!!
===== 1 failed, 1 passed, 1 skipped, 1 error in 51.01s =====
"""


def test_results_are_summed_up_in_one_line():
    outcome = Outcome(stopped=True)
    for line in PRINTED.splitlines(keepends=True):
        outcome.hear(line)
    assert outcome.closed
    lines, good = report({"default": outcome, "fuzz": Outcome(passed=3), "isa": None}, 61.0)
    assert not good
    assert lines == [
        "FAILED tests/a.py::bad",
        "FAILED tests/a.py::worse[1 2]",
        "left out: 8 of 12 tests of the tier default",
        "left out: the tier isa",
        "4 passed, 2 failed, 1 skipped in 61.00s",
    ]


def test_what_was_left_out_is_no_failure():
    _, good = report({"default": Outcome(passed=1), "fuzz": Outcome(stopped=True)}, GRACE)
    assert good


def test_a_session_without_tests_is_no_success():
    lines, good = report({"default": None}, GRACE)
    assert not good
    assert lines == ["left out: the tier default", "0 passed, 0 failed, 0 skipped in 60.00s"]
