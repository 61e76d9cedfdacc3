"""The laws that scenarios name are those that the core has, with the same parameters."""

from __future__ import annotations

import pytest

from doseki.scenario.materials import (
    EQUATIONS_OF_STATE,
    HYPERELASTIC_LAWS,
    RHEOLOGIES,
)

from ..simulations import WATER

FAMILIES = {
    "rheologies": RHEOLOGIES,
    "equations_of_state": EQUATIONS_OF_STATE,
    "hyperelastic_laws": HYPERELASTIC_LAWS,
}
OPTIONS = {
    "eta": 1.2, "alpha": 1.0, "cflnumber": 0.1, "cfl_force": 0.1, "skin": 0.05, "balsara": True,
    "sym_grad": False, "tension": "free", "h_mode": "constant", "gravity": [0.0, 0.0],
    "periodic": [False, False], "domain_min": [0.0, 0.0], "domain_max": [0.0, 0.0],
}  # fmt: skip


@pytest.mark.parametrize("family", FAMILIES)
def test_core_and_scenarios_have_the_same_laws(physics, family):
    assert set(getattr(physics, family)) == set(FAMILIES[family])


@pytest.mark.parametrize("family", FAMILIES)
def test_parameters_of_a_law_reach_the_core(physics, family):
    for name, members in getattr(physics, family).items():
        own = {parameter.name for parameter in FAMILIES[family][name].parameters}
        assert own <= set(members), name


@pytest.mark.parametrize("key", ["rheology", "eos"])
def test_an_unknown_law_is_refused(core, key):
    with pytest.raises(ValueError, match='no law is called "teapot"; known: '):
        core.Simulation("ueta2022", 2, "double", [WATER | {key: "teapot"}], OPTIONS)


@pytest.mark.parametrize("key", ["nu", "rho0", "friction", "restitution"])
def test_a_missing_parameter_is_refused(core, key):
    table = {name: value for name, value in WATER.items() if name != key}
    with pytest.raises(ValueError, match=f'materials.0.: "{key}" is missing'):
        core.Simulation("ueta2022", 2, "double", [table], OPTIONS)
