"""What `doseki bench` times: a block of water and basalt turning slowly, as a simulation."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from ..compiled import load_core
from ..errors import ResourceError
from ..scenario.materials import BUILT_IN, equation_of_state
from ..scenario.schemes import (
    RESOLVED,
    RESOLVED_CFLNUMBER,
    RESOLVED_ETA,
    RESOLVED_KERNEL,
    UETA2022,
)
from ..solver.build import core_material
from ..solver.protocol import CoreSimulation
from ..util.memory import available_bytes

DP = 0.01  # m
ETA = 1.2
XI = 0.05  # eq. 19, as on the flume
JITTER = 0.1  # spacings; a lattice would flatter lists and caches
MOVED_PER_STEP = 0.005  # spacings that the fastest particle goes in a step; the flume: 0.002
BYTES_TO_MAKE = 1200  # per particle, while a simulation is made (a guess on the safe side)
MATERIALS = {UETA2022: ("water", "basalt"), RESOLVED: ("water", "water")}
SCHEMES = tuple(MATERIALS)


@dataclass(frozen=True)
class Case:
    """One simulation to be timed."""

    dim: int
    n: int
    precision: str
    threads: int
    isa: str
    skin: float | str = 0.05
    scheme: str = UETA2022

    @property
    def eta(self) -> float:
        """Smoothing length over spacing."""
        return ETA if self.scheme == UETA2022 else RESOLVED_ETA[RESOLVED_KERNEL]

    @property
    def cflnumber(self) -> float:
        """That of the scheme by default."""
        return 0.1 if self.scheme == UETA2022 else RESOLVED_CFLNUMBER

    @property
    def lanes(self) -> int:
        """Particles that share one list."""
        lanes = load_core(self.isa).lanes
        return 2 * lanes if self.precision == "mixed" and lanes > 1 else lanes


def clocked(threads: int, run: Callable[[], None]) -> tuple[float, float]:
    """Seconds that `run` takes, and processor time over wall time and threads.

    One thread is timed by the processor time it got, so that other programs disturb it only through
    caches; several threads by the wall clock, since they wait for each other.
    """
    wall, processor = time.perf_counter(), time.process_time()
    run()
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    return processor if threads == 1 else wall, processor / (wall * threads)


def block(dim: int, n: int) -> np.ndarray:
    """Exactly n points of a square or cubic lattice, each moved a little at random, (n, dim) m."""
    side = int(np.ceil(n ** (1 / dim) - 1e-9))
    cells = np.indices((side,) * dim).reshape(dim, -1).T[:n]
    return DP * (cells + np.random.default_rng(1).uniform(-JITTER, JITTER, cells.shape))


def vortex(position: np.ndarray, speed: float) -> np.ndarray:
    """An incompressible whirl in the plane of the first two axes that stays within the block."""
    x, y = (np.pi * position[:, a] / np.ptp(position[:, a]) for a in (0, 1))
    velocity = np.zeros_like(position)
    velocity[:, 0] = speed * np.sin(x) * np.cos(y)
    velocity[:, 1] = -speed * np.cos(x) * np.sin(y)
    return velocity


def _options(case: Case) -> dict[str, Any]:
    zero = [0.0] * case.dim
    return {
        "gravity": zero, "eta": case.eta, "alpha": 1.0, "cflnumber": case.cflnumber,
        "cfl_force": 0.1, "skin": 0.05 if case.skin == "auto" else case.skin,
        "auto_skin": case.skin == "auto", "balsara": True, "sym_grad": False,
        "tension": "clamp_fluid", "h_mode": "constant",
        "domain_min": zero, "domain_max": zero, "periodic": [False] * case.dim,
        "flow": {
            "dp": DP, "kernel": RESOLVED_KERNEL, "viscosity": "stress",
            "shifting": True, "acoustic_damping": 0.05,
            "turbulence": "smagorinsky", "smagorinsky": 0.12,
            "walls": [{"no_slip": True, "ks": 0.0}],
        },
    }  # fmt: skip


def make_simulation(case: Case) -> CoreSimulation:
    """The started core simulation; raises ResourceError when it would not fit in memory."""
    simulation = empty_simulation(case)
    fill(simulation, case)
    simulation.start()
    return simulation


def empty_simulation(case: Case) -> CoreSimulation:
    """The core simulation without particles."""
    core = load_core(case.isa)
    core.set_threads(case.threads)
    kind = case.scheme, case.dim, case.precision
    return cast(CoreSimulation, core.Simulation(*kind, _materials(case), _options(case)))


def _materials(case: Case) -> list[dict[str, Any]]:
    eos = equation_of_state(case.scheme, "linear")
    return [core_material(BUILT_IN[name], XI, eos) for name in MATERIALS[case.scheme]]


def fill(simulation: CoreSimulation, case: Case) -> None:
    """Add the particles; raises ResourceError when they would not fit in memory."""
    if case.n * BYTES_TO_MAKE > available_bytes():
        raise ResourceError(f"{case.n} particles do not fit in the memory that is free")
    materials = _materials(case)
    position = block(case.dim, case.n)
    timestep = (
        case.cflnumber * case.eta * DP / max(material["speedsound"] for material in materials)
    )
    index = (position[:, 0] > position[:, 0].mean()).astype(np.int32)
    density = np.array([material["rho0"] for material in materials])[index]
    zeros = np.zeros(case.n, np.int32)
    simulation.add_particles(
        position=position,
        velocity=vortex(position, MOVED_PER_STEP * DP / timestep),
        mass=density * DP**case.dim,
        density=density,
        smoothing_length=np.full(case.n, case.eta * DP),
        material=index,
        body=zeros,
        motion=zeros,
        id=np.arange(case.n),
    )
