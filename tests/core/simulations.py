"""Small simulations, straight from the core."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from doseki.scenario.materials import Material
from doseki.solver.build import core_material

FREE, FIXED = 0, 1
FOREVER = 10**9  # steps


def core_table(
    name: str = "", law: str = "fluid", *, eos: str = "birch_murnaghan", **values: Any
) -> dict[str, Any]:
    """A material as the core reads it; `values` are laid over those of water."""
    water = Material(name, law, 1000.0, 1400.0, shear_modulus=0.0, nu=0.0)
    return core_material(water.with_values(values), 1.0, eos)


# Basalt and water of a run with reduced sound speed.
ROCK = core_table("rock", "solid", rho0=2750.0, speedsound=60.0, shear_modulus=8.4e6)
WATER = core_table("water", rho0=1000.0, speedsound=70.0, nu=1e-6)
OPTIONS = {
    "eta": 1.2, "alpha": 0.0, "cflnumber": 0.1, "cfl_force": 0.1, "skin": 0.1, "balsara": True,
    "sym_grad": False, "tension": "free", "h_mode": "constant",
}  # fmt: skip


@dataclass
class Simulations:
    """Makes simulations with one compiled core."""

    core: ModuleType

    def __call__(
        self,
        position: np.ndarray,
        velocity: np.ndarray,
        *,
        materials: tuple[dict[str, Any], ...] = (ROCK,),
        dp: float = 0.01,
        precision: str = "double",
        columns: dict[str, Any] | None = None,
        domain: tuple[list[float], list[float]] | None = None,
        inflows: tuple[dict[str, Any], ...] = (),
        outflows: tuple[tuple[list[float], list[float]], ...] = (),
        motions: tuple[dict[str, Any], ...] = (),
        **options: Any,
    ) -> Any:
        """A started simulation of particles of spacing `dp` at rest density.

        `columns` replaces default columns of the particles (mass, density, smoothing_length,
        material, body, motion, id); a `domain` (low, high) is periodic along every axis.
        """
        n, dim = np.shape(position)
        low, high = domain or ([0.0] * dim, [0.0] * dim)
        options = OPTIONS | {"gravity": [0.0] * dim} | options
        options |= {"periodic": [domain is not None] * dim, "domain_min": low, "domain_max": high}
        simulation = self.core.Simulation("ueta2022", dim, precision, list(materials), options)
        simulation.add_particles(
            position=np.array(position, float, order="C"),
            velocity=np.array(np.broadcast_to(velocity, (n, dim)), float, order="C"),
            **particle_columns(n, dim, dp, materials, columns or {}),
        )
        for inflow in inflows:
            simulation.add_inflow(inflow)
        for outflow in outflows:
            simulation.add_outflow(*outflow)
        for motion in motions:
            simulation.move_body(motion)
        simulation.start()
        return simulation


def particle_columns(
    n: int, dim: int, dp: float, materials: tuple[dict[str, Any], ...], given: dict[str, Any]
) -> dict[str, np.ndarray]:
    """The columns besides position and velocity: `given` ones over the defaults."""
    material = np.array(np.broadcast_to(given.get("material", 0), n), np.int32)
    rho0 = np.array([table["rho0"] for table in materials])[material]
    columns = (
        {
            "mass": rho0 * dp**dim,
            "density": rho0,
            "smoothing_length": 1.2 * dp,
            "body": 0,
            "motion": FREE,
            "id": np.arange(n),
        }
        | given
        | {"material": material}
    )
    types = dict.fromkeys(("material", "body", "motion"), np.int32) | {"id": np.int64}
    return {
        name: np.array(np.broadcast_to(values, n), types.get(name, np.float64))
        for name, values in columns.items()
    }


def lattice(counts: tuple[int, ...], dp: float = 0.01) -> np.ndarray:
    """Positions (N, dim) of a block of particles around the origin."""
    axes = [dp * (np.arange(n) - 0.5 * (n - 1)) for n in counts]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(counts))


def run_to(simulation: Any, time: float) -> Any:
    """The same simulation, at `time`."""
    simulation.advance(limit=time, pause=time, max_steps=FOREVER)
    return simulation


@dataclass
class Grains:
    """Two lattice grains that collide, as positions and velocities."""

    position: np.ndarray
    velocity: np.ndarray


def colliding_grains(dim: int, across: int = 5) -> Grains:
    """Two jittered cubes of particles, one cell apart, that approach at 4 m/s off centre."""
    random = np.random.default_rng(3)
    block = lattice((across,) * dim)
    block = block + 0.001 * random.uniform(-1, 1, block.shape)
    offset = np.zeros(dim)
    offset[0], offset[1] = 0.01 * (across + 1), 0.015
    velocity = np.zeros((2 * len(block), dim))
    velocity[: len(block), 0], velocity[len(block) :, 0] = 2.0, -2.0
    return Grains(np.concatenate([block, block + offset]), velocity)
