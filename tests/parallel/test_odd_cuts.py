"""Whatever the decomposition, a run is that of one rank."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import doseki

from ..loads.scenes import RAIN

QUANTITIES = ("momentum_x", "momentum_y", "kinetic_energy", "impulse_x", "impulse_y", "scheme_work")
# Grains that come down on a dry sill beside water: one rank may have all of the film between two
# faces, and none of the water it comes from.
RAIN_UNTIL = ("--set", "time_out=0.03", "--set", "time_max=0.05")
CHUTE = ("--set", "dp=0.2", "--set", "time_out=0.05", "--set", "time_max=0.1")
SLIDE = ("--set", "time_out=0.05", "--set", "time_max=0.05")


def run(command: Callable[..., Any], ranks: int, what: Path | str, folder: Path, *more: str) -> Any:
    """The history of a run."""
    words = ("run", what, "-o", folder, "--no-figures", "--threads", 1, *more)
    done = command(ranks, *words, script="odd_cuts.py" if ranks > 1 else None)
    assert done.returncode == 0, done.stderr
    return doseki.load(folder).history


@pytest.fixture(scope="module")
def rain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("rain") / "rain.toml"
    file.write_text(RAIN)
    return file


def assert_same(one: Any, other: Any) -> None:
    np.testing.assert_array_equal(one["step"], other["step"])
    for name in QUANTITIES:
        scale = np.abs(one[name]).max()
        np.testing.assert_allclose(other[name], one[name], rtol=0, atol=1e-9 * scale, err_msg=name)


@pytest.mark.parametrize("seed", ["1", "3"])
def test_grains_water_and_films(command, rain, tmp_path, monkeypatch, seed):
    monkeypatch.setenv("ODD_CUTS", seed)
    one = run(command, 1, rain, tmp_path / "one", *RAIN_UNTIL)
    assert_same(one, run(command, 2, rain, tmp_path / "two", *RAIN_UNTIL))


@pytest.mark.ranks
@pytest.mark.parametrize("seed", ["2", "4", "5"])
@pytest.mark.parametrize(
    ("name", "more"), [("rain", RAIN_UNTIL), ("voellmy-chute", CHUTE), ("saturated-slide", SLIDE)]
)
def test_three_ranks(command, rain, tmp_path, monkeypatch, seed, name, more):
    monkeypatch.setenv("ODD_CUTS", seed)
    what = rain if name == "rain" else name
    one = run(command, 1, what, tmp_path / "one", *more)
    assert_same(one, run(command, 3, what, tmp_path / "three", *more))
