"""Particle sets for the oracle tests: two colliding grains, clouds with nothing regular in them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

RHO0 = 2750.0
RADIUS = 0.005  # of a grain, m
IMPACT_SPEED = 6.0  # m/s
XI = 60 / 3116  # reduced sound speed of the collision


def material(law: str, rho0: float, speedsound: float, stiffness: float) -> SimpleNamespace:
    """A material; `stiffness` is the shear modulus in Pa of a solid, nu in m2/s of a fluid."""
    solid = law == "solid"
    return SimpleNamespace(
        law=law,
        rho0=rho0,
        speedsound=speedsound,
        shear_modulus=stiffness if solid else 0.0,
        nu=0.0 if solid else stiffness,
    )


# Viscosity and moduli large enough that no term is lost beside another one.
MATERIALS = [
    material("fluid", 1000.0, 70.0, 0.02),
    material("solid", 2750.0, 156.0, 5.7e7),
    material("solid", 2700.0, 264.0, 6.4e7),
]


def particle_set(position: np.ndarray, **arrays: Any) -> SimpleNamespace:
    """The arrays of a ParticleSet; what is not given is zero (density and mass must be given)."""
    n = len(position)
    defaults = {
        "velocity": np.zeros_like(position),
        "material": np.zeros(n, np.int32),
        "body": np.zeros(n, np.int32),
        "motion": np.zeros(n, np.int32),
        "id": np.arange(n, dtype=np.int64),
    }
    return SimpleNamespace(position=position, **(defaults | arrays))


def grain_pair(distance: float = 0.025) -> SimpleNamespace:
    """Two grains of one particle each, the right one flying at the left one."""
    mass = RHO0 * np.pi * RADIUS**2
    return particle_set(
        np.array([[-distance / 2, 0.0], [distance / 2, 0.0]]),
        velocity=np.array([[0.0, 0.0], [-IMPACT_SPEED, 0.0]]),
        mass=np.full(2, mass),
        density=np.full(2, RHO0),
        smoothing_length=np.full(2, 1.2 * np.sqrt(mass / RHO0)),
    )


def basalt(xi: float) -> SimpleNamespace:
    """Basalt with a sound speed reduced by `xi`."""
    return material("solid", RHO0, 3116 * xi, 22.7e9 * xi**2)


def random_cloud(
    dim: int, seed: int = 1, h_ratio: float = 1.0, fixed: float = 0.0, n: int = 150
) -> SimpleNamespace:
    """`n` particles of three materials in the unit box, some 20 to 60 neighbours each.

    Smoothing lengths spread over `h_ratio`; a fraction `fixed` of the particles is fixed. Densities
    lie on both sides of rho0, so that pressures of both signs occur.
    """
    random = np.random.default_rng(seed)
    spacing = n ** (-1 / dim)
    materials = random.integers(0, len(MATERIALS), n).astype(np.int32)
    rho0 = np.array([m.rho0 for m in MATERIALS])[materials]
    h = 1.2 * spacing * h_ratio ** random.uniform(-0.5, 0.5, n)
    is_fixed = random.uniform(size=n) < fixed
    return particle_set(
        random.uniform(0, 1, (n, dim)),
        velocity=np.where(is_fixed[:, None], 0, random.normal(0, 2, (n, dim))),
        mass=rho0 * (h / 1.2) ** dim,
        density=rho0 * random.uniform(0.97, 1.04, n),
        smoothing_length=h,
        material=materials,
        motion=is_fixed.astype(np.int32),
    )


def lattice(dim: int, half_width: int, spacing: float) -> np.ndarray:
    """Positions of a square or cubic lattice centred on a particle at the origin."""
    axis = spacing * np.arange(-half_width, half_width + 1)
    return np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
