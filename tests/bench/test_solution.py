"""bench/solution.py: doseki's own part, and what is said where a peer's sources are not there."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from doseki.solver.build import load_core

SOURCE = Path(__file__).resolve().parents[2] / "bench" / "solution.py"
if not SOURCE.exists():
    pytest.skip("bench/ is not part of the source distribution", allow_module_level=True)


@pytest.fixture(scope="module")
def solution():
    """The module, which is no part of the package."""
    spec = importlib.util.spec_from_file_location("solution", SOURCE)
    module = importlib.util.module_from_spec(spec)
    sys.modules["solution"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["solution"]


@pytest.fixture(autouse=True)
def threads_as_before():
    """Leaves the number of threads as it was."""
    core = load_core()
    threads = core.threads()
    yield
    core.set_threads(threads)


def test_the_case_is_the_shipped_dam_break(solution):
    case = solution.DamBreak(rows=20, end=0.05)
    _, fixed = case.particles()
    width, height, length, _ = case.box()
    assert (width, height, length) == pytest.approx((0.3, 0.6, 1.5))
    assert (~fixed).sum() == round(width * height / case.dp**2)
    assert case.radius == pytest.approx(2.78 * case.dp)
    assert case.sound_speed == pytest.approx(10 * np.sqrt(2 * case.gravity * height), rel=1e-3)


def test_a_table_of_one_code_has_its_own_ratio(solution):
    case = solution.DamBreak(rows=20, end=0.2)
    table = solution.measure([solution.Doseki()], case, 1, repeats=1)
    cells = [cell.strip() for cell in table.splitlines()[-1].strip("|").split("|")]
    assert cells[0] == "doseki, resolved"
    assert cells[-1] == "1.00"
    assert int(cells[1]) > 100
    fallen = 0.5 * case.gravity * case.end**2
    assert 0.3 + 0.2 * fallen < float(cells[3]) < 0.3 + 2 * fallen


@pytest.mark.parametrize("peer", ["DualSPHysics", "SPHinXsys"])
def test_a_folder_without_the_sources_is_named(solution, peer, tmp_path):
    with pytest.raises(SystemExit, match=f"{tmp_path}: no .* there"):
        getattr(solution, peer)(tmp_path)


def test_a_command_that_fails_shows_its_last_words(solution, tmp_path):
    with pytest.raises(SystemExit, match=r"(?s)python.* failed:.*no such case"):
        solution.timed_command(
            [sys.executable, "-c", "raise SystemExit('no such case')"], 1, tmp_path
        )
