"""The core against the plain reference, on random particles: every lane width, list and option."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import pytest

from doseki.solver.build import load_core

from ..instruction_sets import INSTRUCTION_SETS
from ..simulations import core_table
from .clouds import MATERIALS, random_cloud
from .reference import Options, Reference

GRAVITY = [1.0, -9.8, -2.0]
MANY_STEPS = 10**6
VOID_RATIO = (5 / 7) ** 1.5  # rho/rho0 at which eq. 8 has its minimum


@dataclass(frozen=True)
class Case:
    """What differs from an open cloud of free particles with equal smoothing lengths.

    `cloud` are arguments of random_cloud, `options` those of the scheme; `periodic` names axes.
    """

    cloud: dict[str, Any] = field(default_factory=dict)
    options: dict[str, Any] = field(default_factory=dict)
    periodic: str = ""

    def all_options(self, dim: int) -> dict[str, Any]:
        """Options for the unit box in `dim` dimensions."""
        box = {"domain_min": [0.0] * dim, "domain_max": [1.0] * dim}
        return self.options | box | {"periodic": [axis in self.periodic for axis in "xyz"[:dim]]}


CASES = {
    "equal h": Case(),
    "h up to 4:1": Case({"h_ratio": 4.0}),
    "h up to 4:1, symmetric gradient": Case({"h_ratio": 4.0}, {"sym_grad": True}),
    "fixed particles": Case({"fixed": 0.4}),
    "fixed particles, tension allowed": Case({"fixed": 0.4, "h_ratio": 2.0}, {"tension": "free"}),
    "no tension": Case({}, {"tension": "clamp_all"}),
    "no Balsara switch": Case({}, {"balsara": False}),
    "no artificial viscosity": Case({}, {"alpha": 0.0}),
    "no strength": Case({}, {"strength": False}),
    "h by eq. 10": Case({"h_ratio": 2.0}, {"h_mode": "eq10"}),
    # Supports must fit twice into a period.
    "periodic": Case({"n": 500}, {}, "xyz"),
    "periodic in x, h up to 2:1": Case({"n": 900, "h_ratio": 2.0}, {}, "x"),
}
STEPPED = ["h up to 4:1", "fixed particles", "h by eq. 10", "periodic"]


@pytest.fixture(params=INSTRUCTION_SETS)
def isa(request: pytest.FixtureRequest) -> str:
    """An instruction set that was built and can run here."""
    return request.param


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request: pytest.FixtureRequest) -> int:
    """Number of space dimensions."""
    return request.param


def make_reference(dim: int, name: str) -> Reference:
    """The reference simulation of a case."""
    case = CASES[name]
    cloud = random_cloud(dim, **case.cloud)
    return Reference(cloud, MATERIALS, GRAVITY[:dim], case.all_options(dim))


@cache
def reference_rates(dim: int, name: str) -> dict[str, Any]:
    """Rates of a case at its start, worked out once for all instruction sets."""
    return make_reference(dim, name).rates()


@cache
def stepped_reference(dim: int, name: str) -> Reference:
    """A case after some eight steps, the last of them cut.

    No particle is yet stretched so far that it counts as a void, a rule the reference lacks.
    """
    reference = make_reference(dim, name)
    reference.advance(7.5 * reference_rates(dim, name)["dt"])
    assert (reference.state.rho / reference.rho0).min() > VOID_RATIO
    return reference


def make_core(isa: str, dim: int, name: str, precision: str = "double", skin: float = 0.1) -> Any:
    """The core's simulation of a case, started."""
    options = CASES[name].all_options(dim)
    core = load_core(isa).Simulation(
        "ueta2022",
        dim,
        precision,
        core_materials(options.get("strength", True)),
        Options(**options).of_core() | {"gravity": GRAVITY[:dim], "skin": skin},
    )
    core.add_particles(**vars(random_cloud(dim, **CASES[name].cloud)))
    core.start()
    return core


def core_materials(strength: bool) -> list[dict[str, Any]]:
    """The materials as the core reads them: without strength, mu = 0."""
    change = {} if strength else {"shear_modulus": 0.0}
    return [core_table(str(k), **vars(m) | change) for k, m in enumerate(MATERIALS)]


def assert_close(actual: dict, expected: dict, tolerance: float) -> None:
    """Equal arrays for each name in `expected`, up to `tolerance` of the largest value of each."""
    for name, values in expected.items():
        atol = tolerance * np.abs(values).max()
        np.testing.assert_allclose(actual[name], values, rtol=0, atol=atol, err_msg=name)


def compare_rates(core: Any, reference: dict[str, Any], tolerance: float) -> None:
    """Asserts equal rates, stresses and time step; the velocity gradient shows in them."""
    rates = core.rates() | core.state()
    names = ["density_rate", "deviatoric_stress_rate", "acceleration", "balsara"]
    names += ["pressure", "sound_speed", "stress"]
    assert_close(rates, {name: reference[name] for name in names}, tolerance)
    assert rates["timestep"] == pytest.approx(reference["dt"], rel=tolerance)


@pytest.mark.parametrize("name", CASES)
def test_rates_in_double(isa: str, dim: int, name: str) -> None:
    compare_rates(make_core(isa, dim, name), reference_rates(dim, name), 1e-12)


@pytest.mark.parametrize("name", STEPPED)
def test_rates_in_mixed_precision(isa: str, dim: int, name: str) -> None:
    compare_rates(make_core(isa, dim, name, "mixed"), reference_rates(dim, name), 2e-5)


@pytest.mark.parametrize("name", STEPPED)
def test_states_after_some_steps(isa: str, dim: int, name: str) -> None:
    """Also what needs stress to be there, and lists that were renewed on the way (thin skin)."""
    reference = stepped_reference(dim, name)
    core = make_core(isa, dim, name, skin=0.005)
    core.advance(limit=reference.time, pause=reference.time, max_steps=MANY_STEPS)
    assert core.rebuilds > 1
    assert (core.time, core.steps) == (reference.time, reference.step)
    state = core.state()
    ours = reference.state
    # The core brings particles back into a periodic box only when it renews its lists.
    periodic = np.isfinite(reference.box)
    state["position"][:, periodic] -= np.round((state["position"] - ours.x)[:, periodic])
    expected = {
        "position": ours.x,
        "velocity": ours.v,
        "density": ours.rho,
        "smoothing_length": ours.h,
        "deviatoric_stress": ours.S,
    }
    assert_close(state, expected, 1e-12)
