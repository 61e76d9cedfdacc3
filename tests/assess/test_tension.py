"""What the trust report says of water that can bear no more tension."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from doseki.assess.trust.tension import Hanging, hanging, tension_check
from doseki.assess.trust.verdicts import BAD, GOOD, NOT_AVAILABLE
from doseki.record.particles import BOUND, FREE
from doseki.scenario.materials import complete_materials

DP = 0.1
SCENARIO = {"scheme": "resolved", "kernel": "wendland_c2", "dp": DP, "xi": 0.01}
STIFFNESS = 1000 * 14**2  # rho c^2, Pa


@dataclass
class Frame:
    """A row of ten particles of water and one of a body at its end."""

    pressure: np.ndarray
    time: float = 1.0
    fields: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = len(self.pressure)
        self.fields = {
            "position": np.column_stack([DP * np.arange(n + 1), np.zeros(n + 1)]),
            "pressure": np.append(self.pressure, 0.0),
            "smoothing_length": np.full(n + 1, 1.3 * DP),
            "motion": np.array([FREE] * n + [BOUND]),
            "material": np.array(["water"] * n + ["basalt"]),
            "body": np.array(["sea"] * n + ["stone"]),
        }

    def __getitem__(self, key: str) -> Any:
        return self.fields[key]


def found(pressure: np.ndarray, eos: str = "linear", **water: float) -> Hanging:
    materials = complete_materials({"water": water} if water else {}) | complete_materials({})
    if water:
        materials["water"] = materials["water"].with_values(water)
    scenario = SCENARIO | {"eos": eos}
    seen = hanging(scenario, Frame(pressure), materials)  # type: ignore[arg-type]
    assert seen is not None
    return seen


def test_water_at_rest_hangs_on_nothing():
    seen = found(np.full(10, 100.0))
    assert seen.share == 0
    assert seen.bodies == ()


def test_any_tension_at_a_body_is_on_the_bound():
    pressure = np.full(10, 100.0)
    pressure[-1] = -1.0
    seen = found(pressure)
    assert seen.share == pytest.approx(0.1)
    assert seen.bodies == ("stone",)


def test_air_entry_suction_lets_it_bear_more():
    pressure = np.full(10, 100.0)
    pressure[-1] = -1.0
    assert found(pressure, air_entry_suction=5.0).share == 0


def test_away_from_bodies_it_hangs_on_the_density_or_on_cavitation():
    pressure = np.full(10, 100.0)
    pressure[0] = -0.0199 * STIFFNESS
    assert found(pressure).share == 0
    assert found(pressure, cavitation_pressure=-1000.0).share == pytest.approx(0.1)
    pressure[0] = -0.02 * STIFFNESS
    assert found(pressure).share == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("eos", "water", "least"),
    [
        ("linear", {}, -0.02),
        ("tait", {}, (0.98**7 - 1) / 7),
        ("stiffened_gas", {"gamma": 3.0}, (0.98**3 - 1) / 3),
    ],
)
def test_the_bound_is_the_pressure_at_the_least_density(eos, water, least):
    pressure = np.full(10, 100.0)
    pressure[0] = 0.99 * least * STIFFNESS
    assert found(pressure, eos, **water).share == 0
    pressure[0] = least * STIFFNESS
    assert found(pressure, eos, **water).share == pytest.approx(0.1)


def test_the_check_names_time_and_bodies():
    check = tension_check([Hanging(1, 0.0, ()), Hanging(2, 0.01, ("stone",)), Hanging(3, 0.1, ())])
    assert check.verdict == BAD
    assert check.details["since"] == 2
    named = tension_check([Hanging(1, 0.0, ()), Hanging(2, 0.1, ("stone", "block"))])
    assert "since 2 s near stone, block" in named.remedy
    assert tension_check([Hanging(1, 0.0, ())]).verdict == GOOD
    assert tension_check([]).verdict == NOT_AVAILABLE
