"""Columns of the census: nothing depends on where the scene lies, and side walls are no bed."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.census.census import CLASSES, classify, take_census
from doseki.measure.census.columns import Columns, plan_of
from doseki.measure.census.grains import Grains, Surroundings
from doseki.record.reader import load

from ..synthetic_runs import make_plain_state

DP, DEEP, D = 0.02, 0.4, 0.1  # m: spacing, depth of the water, diameter of the grains
LONG = 1.0  # m, of the tank


def lattice(low, high):
    x, y = (np.arange(a + DP / 2, b, DP) for a, b in zip(low, high, strict=True))
    return np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2)


def tank(shift=0.0):
    """(water, fixed) of a still tank with walls of 0.6 m, which begins at x = `shift`."""
    walls = [((-0.1, -0.1), (LONG + 0.1, 0)), ((-0.1, 0), (0, 0.6)), ((LONG, 0), (LONG + 0.1, 0.6))]
    fixed = np.concatenate([lattice(*wall) for wall in walls])
    moved = np.array([shift, 0.0])
    return lattice((0, 0), (LONG, DEEP)) + moved, fixed + moved


def discs(*places, diameter=D):
    """Grains that move at 0.3 m/s along -x."""
    position, n = np.array(places, float), len(places)
    velocity = np.tile([-0.3, 0.0], (n, 1))
    return Grains(
        np.arange(n), position, velocity, np.zeros((n, 3)), np.zeros(n, int),
        np.full(n, diameter), np.ones(n), np.zeros(n, bool),
    )  # fmt: skip


def around_of(water, fixed):
    volume = np.full(len(water), DP**2)
    return Surroundings(water, volume, fixed, np.full(len(fixed), DP))


@pytest.mark.parametrize("shift", [0, 0.04, 0.1, 0.14])
@pytest.mark.parametrize("direction", [-1, 1])
def test_classes_and_front_go_with_the_scene(shift, direction):
    some = discs((0.915 + shift, 0.33), (0.5 + shift, 0.33), (0.5 + shift, 0.15))
    around = around_of(*tank(shift))
    kinds, front = classify(some, some.position, around, direction)
    assert [CLASSES[k] for k in kinds] == ["floating", "floating", "carried"]
    assert front - shift == pytest.approx(LONG if direction > 0 else 0, abs=1e-9)


@pytest.mark.parametrize("diameter", [0.1, 0.13])
def test_walls_are_no_bed_and_take_no_area(diameter):
    """Also where the last column is cut by the wall."""
    some = discs((0.915, 0.33), (0.1, 0.33), diameter=diameter)
    around = around_of(*tank())
    columns = Columns(some, around, plan_of(some, around))
    assert columns.bed[columns.of_grain] == pytest.approx(0, abs=1e-9)
    assert columns.water[columns.of_grain] == pytest.approx(DEEP, rel=0.1)


def test_columns_stay_as_wide_as_at_first(tmp_path, record_run):
    """Grains that come later do not change where the front of the water is looked for."""

    def state(time):
        water, fixed = tank()
        grain = np.array([[0.5, 0.33]] if time < 0.5 else [[0.5, 0.33], [0.51, 0.2], [0.6, 0.2]])
        position = np.concatenate([water, grain, fixed])
        kind = np.repeat([0, 1, 2], [len(water), len(grain), len(fixed)])
        made = make_plain_state(position, np.zeros_like(position), kind)
        mass = np.where(kind == 1, 1.0 if time < 0.5 else 9.0, DP**2)
        return made | {"mass": mass, "density": np.ones(len(mass))}

    record_run(tmp_path / "run", state_at=state)[0].close({})
    run = load(tmp_path / "run")
    used = []
    with pytest.MonkeyPatch.context() as patch:

        def noted(*given):
            used.append(given[-1])
            return classify(*given)

        patch.setattr("doseki.measure.census.census.classify", noted)
        take_census(run)
    assert len(used) > 1
    assert {plan.width for plan in used} == {used[0].width}
