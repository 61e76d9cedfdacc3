"""What acts on one particle, term by term, from the fields of a state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from .core import load_core
from .particles import FREE, SUPPORT
from .scenario import Scenario
from .schemes import KERNEL_SUPPORT, RESOLVED

State = Mapping[str, np.ndarray]
# Of the core: the kernel, and what it sums to on a lattice.
KERNEL_FUNCTIONS = {
    "wendland_c2": ("wendland_c2", "lattice_sums_c2"),
    "wendland_c6": ("kernel", "lattice_sums_c6"),
}
RATES = ("balsara", "acceleration")  # what the terms need of the rates of the core


@dataclass
class Terms:
    """The neighbours of a particle, and what enters its acceleration and its timestep."""

    neighbour: np.ndarray  # (n,) indices into the state
    distance: np.ndarray  # (n,), m
    acceleration: dict[str, np.ndarray]  # (dim,) each, m/s2, by term of eq. (12) or (27)
    timestep: dict[str, float]  # s, by condition of eq. (18), or of the resolved scheme


def particle_terms(scenario: Scenario, state: State, k: int) -> Terms:
    """Terms of particle `k` of `state`: fields of the core, and of its rates what `RATES` names.

    The sums are those of the core at the end of a step, not of the state predicted within it.
    """
    offset = _offsets(scenario, state, k)
    distance = np.linalg.norm(offset, axis=1)
    reach = KERNEL_SUPPORT[scenario.kernel]
    h = state["smoothing_length"]
    near = np.flatnonzero(distance < reach * np.maximum(h, h[k]))
    near = near[near != k]
    terms_of = _flow_terms if scenario.scheme == RESOLVED else _stress_terms
    terms, timestep = terms_of(scenario, state, k, near, offset[near])
    return Terms(near, distance[near], terms, timestep)


def _flow_terms(
    scenario: Scenario, state: State, k: int, near: np.ndarray, offset: np.ndarray
) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """Those of the resolved scheme: pressure among fluids, eq. (27), gravity, and what is left."""
    total = state["acceleration"][k]
    laws = np.array([scenario.materials[name].law for name in scenario.material_names])
    fluid = laws[state["material"]] == "fluid"
    among = fluid[near] & fluid[k]
    j, r = near[among], offset[among]
    rho, p, h = state["density"], state["pressure"], float(state["smoothing_length"][k])
    support = np.full(len(j), scenario.support)
    gradient = _gradient(scenario.dim, scenario.kernel, np.linalg.norm(r, axis=1), support)
    sums = _physics(scenario.dim, KERNEL_FUNCTIONS[scenario.kernel][1])
    moment = sums([[scenario.dp], [scenario.support]])[1][0]
    weight = -state["mass"][j] / rho[j] * (p[j] + p[k]) * gradient / (rho[k] * moment)
    terms = {"pressure": weight @ r, "gravity": np.array(scenario.gravity, float)}
    if state["motion"][k] != FREE:
        terms = {name: np.zeros(scenario.dim) for name in terms}
    terms["viscosity_and_walls"] = total - sum(terms.values())
    speed, strength = (float(np.linalg.norm(v)) for v in (state["velocity"][k], total))
    c = float(state["sound_speed"][k])
    return terms, {
        "the sound speed": scenario.cflnumber * h / (c + speed),
        "the acceleration": scenario.cfl_force * float(np.sqrt(h / max(strength, 1e-300))),
    }


def _stress_terms(
    scenario: Scenario, state: State, k: int, near: np.ndarray, offset: np.ndarray
) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """Those of the paper's scheme."""
    h = state["smoothing_length"]
    pairs = _Pairs(scenario, state, k, near, offset)
    terms = {
        "pressure": pairs.sum(pairs.traction(pairs.isotropic)),
        "deviatoric_stress": pairs.sum(pairs.traction(pairs.deviator)),
        "artificial_viscosity": pairs.sum(-pairs.viscosity()[:, None] * pairs.offset),
        "gravity": np.array(scenario.gravity, float),
    }
    if state["motion"][k] != FREE:
        terms = {name: np.zeros(scenario.dim) for name in terms}
    total = float(np.linalg.norm(sum(terms.values())))
    timestep = {
        "the signal velocity": scenario.cflnumber * 2 * h[k] / pairs.largest_signal,
        "the acceleration": scenario.cfl_force * float(np.sqrt(h[k] / max(total, 1e-300))),
    }
    return terms, timestep


def _offsets(scenario: Scenario, state: State, k: int) -> np.ndarray:
    """x_k - x_j for every j, through the nearest image where the domain is periodic."""
    offset = state["position"][k] - state["position"]
    for axis in scenario.periodic:
        a = "xyz".index(axis)
        length = scenario.domain_max[a] - scenario.domain_min[a]
        offset[:, a] -= length * np.round(offset[:, a] / length)
    return offset


class _Pairs:
    """Pairs (k, j) of one particle k with its neighbours j, in the paper's symbols."""

    def __init__(
        self, scenario: Scenario, state: State, k: int, j: np.ndarray, offset: np.ndarray
    ) -> None:
        self._state, self._k, self._j = state, k, j
        self._alpha = scenario.alpha
        self.offset = offset
        self.distance = np.linalg.norm(offset, axis=1)
        identity = np.eye(scenario.dim)
        stress = state["stress"][:, : scenario.dim, : scenario.dim]
        self.isotropic = -state["pressure"][:, None, None] * identity
        self.deviator = stress - self.isotropic
        self._weight = state["mass"][j] * _mean_gradient(scenario.dim, state, k, j, self.distance)
        v_dot_r = np.einsum("na,na->n", state["velocity"][k] - state["velocity"][j], offset)
        self._approach = np.minimum(v_dot_r, 0) / np.maximum(self.distance, 1e-300)
        c = state["sound_speed"]
        self._signal = c[k] + c[j] - 3 * self._approach

    @property
    def largest_signal(self) -> float:
        """The largest signal velocity, at least that of matter at rest, m/s."""
        at_rest = 2 * float(self._state["sound_speed"][self._k])
        return max(at_rest, float(self._signal.max(initial=0.0)))

    def traction(self, stress: np.ndarray) -> np.ndarray:
        """(stress_k/rho_k^2 + stress_j/rho_j^2) . r_kj for each pair."""
        rho = self._state["density"]
        at_k, at_j = (
            stress[self._k] / rho[self._k] ** 2,
            stress[self._j] / rho[self._j][:, None, None] ** 2,
        )
        return np.einsum("nab,nb->na", at_k + at_j, self.offset)

    def viscosity(self) -> np.ndarray:
        """Pi_kj of eqs. (13)-(16)."""
        rho, f = self._state["density"], self._state["balsara"]
        switched = self._alpha * 0.5 * (f[self._k] + f[self._j])
        return -switched * self._signal * self._approach / (rho[self._k] + rho[self._j])

    def sum(self, vectors: np.ndarray) -> np.ndarray:
        """The sum over pairs with the gradient of the kernel."""
        return self._weight @ vectors


def _mean_gradient(dim: int, state: State, k: int, j: np.ndarray, r: np.ndarray) -> np.ndarray:
    """F = W'(r)/r, the mean over the smoothing lengths of k and j."""
    h = state["smoothing_length"]
    supports = (SUPPORT * np.full(len(j), h[k]), SUPPORT * h[j])
    return 0.5 * sum(_gradient(dim, "wendland_c6", r, support) for support in supports)


def _gradient(dim: int, kernel: str, r: np.ndarray, support: np.ndarray) -> np.ndarray:
    """F = W'(r)/r (n,) at distances r (n,) for support radii (n,)."""
    if len(r) == 0:
        return np.zeros(0)
    function = _physics(dim, KERNEL_FUNCTIONS[kernel][0])
    return np.array(function([list(r), list(1 / support)])[1])


def _physics(dim: int, name: str) -> Callable[[list[list[float]]], list[list[float]]]:
    """A point function of the core."""
    physics = load_core().physics
    return getattr(physics.two if dim == 2 else physics.three, name)
