"""What the trust report says of the ground of a terrain."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from doseki.assess.trust.ground import ground_check


def run_with(through: float | None, **scenario: Any) -> Any:
    """A run of 200 kg, of which so much went through the ground."""
    said = {"mass_initial": 150.0, "mass_entered": 50.0}
    if through is not None:
        said["mass_through_ground"] = through
    return cast(Any, SimpleNamespace(summary=said, scenario=scenario))


@pytest.mark.parametrize(("through", "verdict"), [(0, "good"), (0.1, "doubtful"), (20, "bad")])
def test_mass_that_went_through_the_ground_is_judged(through, verdict):
    (check,) = ground_check(run_with(through, terrain={"file": "map.tif"}))
    assert check.verdict == verdict
    assert check.value == pytest.approx(through / 200)
    assert ("speed_max" in check.remedy) is (verdict != "good")


def test_runs_without_a_terrain_or_the_number_are_not_judged():
    assert ground_check(run_with(0.0)) == []
    assert ground_check(run_with(None, terrain={"file": "map.tif"})) == []
