"""The resolved scheme against its plain reference: every dimension, wall, law and lane width."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from doseki.solver.build import load_core

from ..instruction_sets import INSTRUCTION_SETS
from ..simulations import core_table
from .flow_reference import (
    LARGEST_EXCESS,
    LEAST_DENSITY,
    SURFACE,
    FlowOptions,
    FlowReference,
    largest_size,
)

GRAVITY = [2.0, -1.0, -9.8]
MATERIALS = [
    {"name": "water", "law": "fluid", "rho0": 1000.0, "speedsound": 20.0, "nu": 0.01},
    {"name": "mud", "law": "fluid", "rho0": 1300.0, "speedsound": 15.0, "nu": 0.05},
    {"name": "rock", "law": "solid", "rho0": 2700.0, "speedsound": 90.0, "nu": 0.0},
]
ACROSS = {2: 14, 3: 8}  # particles along each side of the unit box
STICK = {"no_slip": True, "ks": 0.0}
SLIP = {"no_slip": False, "ks": 0.0}
ROUGH = {"no_slip": False, "ks": 0.02}
ROUGH_AND_VISCOUS = {"no_slip": True, "ks": 0.02}
TOLERANCE, MIXED_TOLERANCE = 1e-10, 2e-5
SLURRY = {
    "rheology": "herschel_bulkley", "yield_stress": 500.0, "consistency": 40.0, "flow_index": 0.6,
    "regularisation": 0.5, "viscosity_max": 90.0,
}  # fmt: skip
GRAINS = {
    "rheology": "mu_i", "mu_s": 0.4, "mu_2": 0.7, "inertial_number": 0.3, "grain_diameter": 0.1,
    "grain_density": 2500.0, "viscosity_max": 90.0,
}  # fmt: skip


@dataclass(frozen=True)
class Case:
    """What differs from an open cloud of water over a no-slip floor, beside a slippery wall."""

    options: dict[str, Any] = field(default_factory=dict)
    walls: tuple[dict[str, Any], ...] = (STICK, STICK, SLIP)  # of fluid, floor and side
    periodic: str = ""
    speed: float = 1.0
    fluids: int = 1
    thinned: float = 0.0  # fraction of the fluid that is taken out
    thicker: float = 1.0  # factor of the viscosities
    rheology: dict[str, Any] = field(default_factory=dict)  # of the second fluid
    edges: bool = False  # of the walls

    @property
    def materials(self) -> list[dict[str, Any]]:
        """MATERIALS with the viscosities of this case."""
        materials = [m | {"nu": self.thicker * m["nu"]} for m in MATERIALS]
        materials[1] |= self.rheology
        return materials


CASES = {
    "open": Case(),
    "spray": Case(thinned=0.6),
    "edges": Case(edges=True),
    "two fluids": Case(fluids=2),
    "free slip": Case(walls=(STICK, SLIP, SLIP)),
    "rough": Case(walls=(STICK, ROUGH, STICK)),
    "rough and viscous": Case(walls=(STICK, ROUGH_AND_VISCOUS, SLIP)),
    "rough, periodic": Case(walls=(STICK, ROUGH, ROUGH), periodic="xy"),
    "periodic": Case(periodic="xyz"),
    "holes, periodic": Case(periodic="xyz", thinned=0.2),
    "two fluids, periodic": Case(periodic="xyz", fluids=2),
    "viscosity limits the step": Case(thicker=1000),
    "hardly moving": Case(periodic="xyz", speed=0.008),
    "no shifting": Case({"shifting": False}),
    "sound undamped": Case({"acoustic_damping": 0.0}),
    "wide kernel": Case({"kernel": "wendland_c6", "eta": 1.2}),
    "wide kernel, periodic": Case({"kernel": "wendland_c6", "eta": 1.2}, periodic="xyz"),
    "Morris": Case({"viscosity": "morris"}),
    "Monaghan and Cleary": Case({"viscosity": "monaghan_cleary"}),
    "slurry": Case(fluids=2, rheology=SLURRY),
    "dense grains": Case(fluids=2, rheology=GRAINS),
    "Tait": Case({"eos": "tait"}),
    "Smagorinsky": Case({"turbulence": "smagorinsky"}),
    "mixing length": Case({"turbulence": "mixing_length"}, walls=(STICK, ROUGH, SLIP)),
    "mixing length, periodic": Case({"turbulence": "mixing_length"}, periodic="xy"),
}


def unit(v: np.ndarray) -> np.ndarray:
    """Vectors (..., dim) of length one; zero stays zero."""
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-9)


def cloud(dim: int, case: Case) -> SimpleNamespace:
    """A jittered lattice in the unit box: two rows of floor, two rows of a side wall, fluid.

    Normals point anywhere around the true ones, so that pairs on both sides of a face occur, and
    each particle has a curvature of its own, or with `edges` several faces.
    """
    random, n = np.random.default_rng(7), ACROSS[dim]
    dp = 1 / n
    axis = (np.arange(n) + 0.5) * dp
    x = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    floor, side = x[:, -1] < 2 * dp, x[:, 0] < 2 * dp
    body = np.where(floor, 1, np.where(side & ("x" not in case.periodic), 2, 0))
    kept = (body > 0) | (random.uniform(size=len(x)) >= case.thinned)
    x, body = x[kept] + random.uniform(-0.15, 0.15, (kept.sum(), dim)) * dp, body[kept]
    fixed = body > 0
    toward = np.zeros_like(x)
    toward[body == 1, -1], toward[body == 2, 0] = 1.0, 1.0
    toward[fixed] += 0.3 * random.normal(size=(fixed.sum(), dim))
    depth = np.where(body == 1, 2 * dp - x[:, -1], 2 * dp - x[:, 0])
    material = np.where(fixed, 2, random.integers(0, case.fluids, len(x))).astype(np.int32)
    rho0 = np.array([m["rho0"] for m in MATERIALS])[material]
    h = case.options.get("eta", 1.3) * dp
    edged = fixed & case.edges
    return SimpleNamespace(
        position=np.clip(x, 1e-9, 1 - 1e-9),
        velocity=case.speed * random.normal(0, 1, x.shape) * np.where(fixed, 0.2, 1)[:, None],
        mass=rho0 * dp**dim,
        density=rho0 * np.where(fixed, 1, random.uniform(0.975, 1.03, len(x))),
        smoothing_length=np.full(len(x), h),
        material=material,
        body=body.astype(np.int32),
        motion=fixed.astype(np.int32),
        id=np.arange(len(x), dtype=np.int64),
        normal=unit(toward),
        depth=np.where(fixed, depth, 0.0),
        curvature=np.where(fixed & ~edged, random.uniform(-0.2, 0.2, len(x)) / dp, 0.0),
        edge_normals=unit(random.normal(size=(len(x), dim, dim))) * edged[:, None, None],
        edge_depths=random.uniform(0, 1.5, (len(x), dim)) * dp * edged[:, None],
    )


@cache
def reference(dim: int, name: str) -> FlowReference:
    """The reference after its two evaluations, worked out once for all instruction sets."""
    case = CASES[name]
    period = np.array([1.0 if axis in case.periodic else np.inf for axis in "xyz"])
    options = FlowOptions(dp=1 / ACROSS[dim], walls=case.walls, period=period, **case.options)
    return FlowReference(cloud(dim, case), case.materials, GRAVITY[-dim:], options).start()


def core_simulation(
    isa: str, dim: int, name: str, skin: float = 0.05, precision: str = "double"
) -> Any:
    """The core's simulation of a case, started."""
    case, particles = CASES[name], vars(cloud(dim, CASES[name]))
    ours = asdict(reference(dim, name).options)
    flow = {
        key: ours[key]
        for key in "dp kernel viscosity acoustic_damping turbulence smagorinsky".split()
    }
    flow |= {"shifting": ours["shifting"], "walls": list(case.walls)}
    options = {key: ours[key] for key in ("eta", "cflnumber", "cfl_force")}
    options |= {"alpha": 0.0, "skin": skin, "balsara": False, "sym_grad": False, "flow": flow}
    options |= {"tension": "free", "h_mode": "constant", "gravity": GRAVITY[-dim:]}
    options |= {"domain_min": [0.0] * dim, "domain_max": [1.0] * dim}
    options["periodic"] = [axis in case.periodic for axis in "xyz"[:dim]]
    materials = [core_table(**m, eos=ours["eos"]) for m in case.materials]
    simulation = load_core(isa).Simulation("resolved", dim, precision, materials, options)
    surface = {key: particles.pop(key) for key in ("normal", "depth", "curvature")}
    normals, depths = particles.pop("edge_normals"), particles.pop("edge_depths")
    simulation.add_particles(**particles)
    simulation.set_walls(**{key: np.ascontiguousarray(v) for key, v in surface.items()})
    simulation.set_edges(normals=normals.reshape(len(depths), -1), depths=depths)
    simulation.start()
    return simulation


def assert_close(
    actual: np.ndarray, expected: np.ndarray, name: str, tolerance: float = TOLERANCE
) -> None:
    """Equal up to a tolerance of the largest value."""
    atol = tolerance * np.abs(expected).max()
    np.testing.assert_allclose(actual, expected, rtol=0, atol=atol, err_msg=name)


@pytest.fixture(params=INSTRUCTION_SETS)
def isa(request: pytest.FixtureRequest) -> str:
    """An instruction set that was built and can run here."""
    return request.param


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request: pytest.FixtureRequest) -> int:
    """Number of space dimensions."""
    return request.param


def compare_rates(core: Any, ours: FlowReference, tolerance: float) -> None:
    """Asserts equal rates, gradients, pressures and time step."""
    rates, state, fluid = core.rates(), core.state(), ours.fluid
    expected = (
        (rates["acceleration"][fluid], ours.acceleration, "acceleration"),
        (rates["density_rate"][fluid], ours.density_rate, "density rate"),
        (state["velocity_gradient"][fluid], ours.L, "velocity gradient"),
        (state["surface"][fluid], ours.surface, "surface"),
        (state["force"][~fluid], ours.wall_force, "force on walls"),
        (state["pressure"][~fluid], ours.wall_pressure, "pressure of walls"),
    )
    for actual, values, name in expected:
        assert_close(actual, values, name, tolerance)
    assert rates["timestep"] == pytest.approx(ours.timestep, rel=tolerance)
    assert rates["av_power"] == pytest.approx(ours.power, rel=tolerance)
    assert (rates["acceleration"][~fluid] == 0).all()
    assert (rates["density_rate"][~fluid] == 0).all()


@pytest.mark.parametrize("name", CASES)
def test_rates(isa: str, dim: int, name: str) -> None:
    compare_rates(core_simulation(isa, dim, name), reference(dim, name), TOLERANCE)


@pytest.mark.parametrize("name", CASES)
def test_rates_in_mixed_precision(isa: str, dim: int, name: str) -> None:
    core = core_simulation(isa, dim, name, precision="mixed")
    compare_rates(core, reference(dim, name), MIXED_TOLERANCE)


@pytest.mark.parametrize("skin", [0.0, 0.6])
@pytest.mark.parametrize("name", ["open", "two fluids, periodic", "wide kernel"])
def test_the_margin_of_lists_adds_nothing(isa: str, dim: int, name: str, skin: float) -> None:
    """Lists without one hold the pairs in reach; those of a wide one many others, and clusters of
    which no particle has the neighbour in reach.
    """
    ours, core = reference(dim, name), core_simulation(isa, dim, name, skin)
    rates, state, fluid = core.rates(), core.state(), ours.fluid
    assert_close(rates["acceleration"][fluid], ours.acceleration, "acceleration")
    assert_close(rates["density_rate"][fluid], ours.density_rate, "density rate")
    assert_close(state["force"][~fluid], ours.wall_force, "force on walls")


@pytest.mark.parametrize("name", ["open", "rough, periodic"])
def test_shift_and_pressure_gradient(isa: str, dim: int, name: str) -> None:
    """They are in a checkpoint, in the order of storage."""
    ours, saved = reference(dim, name), core_simulation(isa, dim, name).checkpoint()
    for key, expected in (("shift", ours.shift), ("pressure_gradient", ours.pressure_gradient)):
        stored = np.asarray(saved[key]).reshape(-1, dim)[: len(expected)]
        assert_close(np.sort(stored, axis=0), np.sort(expected, axis=0), key)


def test_the_cases_reach_every_branch(dim: int) -> None:
    """What no case reaches, no case tests."""
    case = {name: reference(dim, name) for name in CASES}
    slow = case["hardly moving"]
    between = (slow.relaxation > slow.slowest) & (slow.relaxation < slow.fastest)
    assert between.any()
    assert (case["periodic"].relaxation == case["periodic"].fastest).any()
    assert 0 < case["open"].inside.sum() < len(case["open"].x)
    for name in ("open", "spray", "periodic"):
        assert (case[name].rho < LEAST_DENSITY * case[name].rho0).any()
    excess = largest_size(case["holes, periodic"].B - np.eye(dim))
    assert np.isclose(excess, LARGEST_EXCESS).any()
    near = (case["open"].nearby > SURFACE) & (case["open"].measure < SURFACE)
    assert near.any()
    assert (case["spray"].measure == 3).any()
    assert (np.linalg.norm(case["rough"].traction, axis=1) > 0).any()
    front = np.einsum("ija,ja->ij", case["open"].fw.r_ij, case["open"].normal) > case["open"].depth
    assert (front & (case["open"].fw.F < 0)).any()
    assert (~front & (case["open"].fw.F < 0)).any()
    thick = case["viscosity limits the step"]
    assert thick.timestep == 0.9 / thick.viscous_rate.max()
    speeding = [np.linalg.norm(c.L, axis=(1, 2)) * 0.5 * c.h / c.c > 0.0075 for c in case.values()]
    assert any(0 < fast.sum() < len(fast) for fast in speeding)  # Eq. (153)
    for name in ("slurry", "dense grains"):
        mu = case[name].mu[case[name].rho0 == 1300]
        assert 0.01 < np.mean(mu == 90) < 0.9
    length = case["mixing length"]._mixing_length(0.0)
    assert (length > 0.12 / ACROSS[dim]).any()
