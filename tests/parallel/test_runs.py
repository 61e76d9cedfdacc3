"""Whole runs on several ranks: the record of one, to rounding."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import doseki

from ..start.tank import continued, disc, tank_text
from ..start.tank import run as run_tank

# The time that is compared is short of the first splash: from there on any other order of sums, on
# one rank too, leads to other drops.
CASES = {
    # Grains that touch before half of it is over.
    "collision": (
        "particles_per_grain=793",
        "distance=0.0106",
        "time_max=0.0004",
        "time_out=0.0002",
    ),
    "dambreak": ("dim=3", "dp=0.03", "time_max=0.006", "time_out=0.003"),
    "flume": ("dp=0.01", "load_mass=2", "time_max=0.01", "time_out=0.005"),
    # Past its end. With longer steps what rounding changes grows there to 1e-6.
    "channel": (
        "dp=0.01",
        "flume_length=0.2",
        "time_max=0.14",
        "time_out=0.07",
        "cflnumber=0.3",
    ),
    # Friction that springs of the bed hold, on both parts of it.
    "voellmy-chute": ("dp=0.2", "time_max=0.1", "time_out=0.05"),
}
NUMBERS = ("time", "step", "dt")
SHARED = ("imbalance", "share_balance", "share_migrate", "share_halo", "share_wait")

Command = Callable[..., Any]


def settings(name: str, *more: str) -> list[str]:
    """The case as arguments of the command."""
    return [word for setting in (*CASES[name], *more) for word in ("--set", setting)]


def run(command: Command, ranks: int, name: str, folder: Path, *more: str) -> doseki.Run:
    """The case on some ranks."""
    done = command(
        ranks, "run", name, "-o", folder, "--no-figures", "--threads", 1, *settings(name, *more)
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("status ") == 1
    return doseki.load(folder)


def assert_same_snapshots(one: doseki.Run, other: doseki.Run, rounding: float = 1e-11) -> None:
    """Every field of every snapshot, over its largest value."""
    np.testing.assert_array_equal(one.times, other.times)
    for mine, yours in zip(one, other, strict=True):
        np.testing.assert_array_equal(mine["id"], yours["id"])
        for name in ("material", "body", "motion"):
            np.testing.assert_array_equal(mine[name], yours[name])
        for name in ("position", "velocity", "density", "pressure", "stress"):
            scale = np.abs(mine[name]).max(initial=1e-300)
            worst = np.abs(mine[name] - yours[name]).max() / scale
            assert worst < rounding * (1e3 if name in ("pressure", "stress") else 1), name


@pytest.fixture(scope="module")
def on_ranks(
    command: Command, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[int, str], doseki.Run]:
    """Each case on a number of ranks, run once."""

    @cache
    def get(ranks: int, name: str) -> doseki.Run:
        return run(command, ranks, name, tmp_path_factory.mktemp(f"ranks-{ranks}") / name)

    return get


@pytest.mark.parametrize("name", CASES)
def test_a_run_on_two_ranks_is_that_on_one(on_ranks, name):
    one, two = on_ranks(1, name), on_ranks(2, name)
    assert_same_snapshots(one, two)
    assert two.summary["ranks"] == 2
    assert two.history.columns == one.history.columns
    for column in set(one.history) - set(SHARED):
        scale = max(np.abs(one.history[column]).max(), np.abs(one.history["mass"]).max())
        np.testing.assert_allclose(
            two.history[column], one.history[column], atol=1e-6 * scale, rtol=1e-4, err_msg=column
        )
    total = one.history["mass_inside"].max()
    assert abs(two.summary["ledger_residual"]) < 1e-11 * max(total, 1.0)
    assert one.gauges.keys() == two.gauges.keys()
    for gauge, samples in one.gauges.items():
        for column in samples:
            np.testing.assert_allclose(
                two.gauges[gauge][column], samples[column], rtol=1e-4, atol=1e-7
            )


def test_the_history_tells_how_the_work_is_spread(on_ranks):
    one, two = on_ranks(1, "dambreak").history, on_ranks(2, "dambreak").history
    assert np.all(one["imbalance"] == 1)
    assert all(np.all(one[f"share_{name}"] == 0) for name in ("balance", "migrate", "halo", "wait"))
    assert np.all(two["imbalance"] >= 1)
    assert np.all(np.isfinite(two["imbalance"]))
    shares = np.array([two[f"share_{name}"] for name in ("balance", "migrate", "halo", "wait")])
    assert np.all((shares >= 0) & (shares < 1))
    assert shares.max() > 0  # a cut begins the count anew: the last row may have none


@pytest.mark.ranks
@pytest.mark.parametrize("ranks", [3, 4])
@pytest.mark.parametrize("name", CASES)
def test_a_run_on_more_ranks_is_that_on_one(command, on_ranks, tmp_path, name, ranks):
    many = run(command, ranks, name, tmp_path / "many")
    assert_same_snapshots(on_ranks(1, name), many)


@pytest.mark.parametrize(
    ("before", "after"), [pytest.param(2, 3, marks=pytest.mark.ranks), (2, 1), (1, 2)]
)
def test_a_checkpoint_goes_on_with_any_number_of_ranks(command, on_ranks, tmp_path, before, after):
    folder = tmp_path / "run"
    run(command, before, "collision", folder, "time_max=0.0002")
    done = command(
        after, "resume", folder, "--no-figures", "--threads", 1, "--set", "time_max=0.0004"
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("agree to rounding only") == 1
    resumed, straight = doseki.load(folder), on_ranks(1, "collision")
    assert resumed.summary["ranks"] == after
    mine, yours = straight[-1], resumed[-1]
    for name in ("position", "velocity", "density"):
        scale = np.abs(mine[name]).max()
        assert np.abs(mine[name] - yours[name]).max() < 1e-10 * scale, name


def test_ranks_are_started_by_an_option(command, on_ranks, tmp_path):
    done = command(
        1, "run", "collision", "--ranks", 2, "-o", tmp_path / "two", "--no-figures",
        "--threads", 1, *settings("collision"),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    two = doseki.load(tmp_path / "two")
    assert two.summary["ranks"] == 2
    assert_same_snapshots(on_ranks(1, "collision"), two)


def test_a_run_that_starts_from_another_one_is_that_of_one_rank(command, tmp_path):
    """With all of a checkpoint, and from a snapshot with a body that is added."""
    earlier = tmp_path / "earlier.toml"
    earlier.write_text(tank_text())
    run_tank(tank_text(), earlier, "time_max=0.02")
    added = tank_text() + disc("three", 0.1, y=0.3)
    for name, text in (("same", tank_text()), ("added", added)):
        file = tmp_path / f"{name}.toml"
        alone = run_tank(continued(text, "earlier"), file, "time_max=0.022")
        folder = tmp_path / f"{name}-2"
        done = command(
            2, "run", file, "-o", folder, "--no-figures", "--threads", 1, "--set", "time_max=0.022"
        )
        assert done.returncode == 0, done.stderr
        assert_same_snapshots(doseki.load(folder), alone, 1e-9)
