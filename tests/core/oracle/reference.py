"""The ueta2022 scheme written as plainly as possible: every pair is visited, nothing is clever.

An oracle for the core on small sets of particles. It shares no code with it. Equation numbers are
those of the paper (Ueta et al. 2022), with the signs that the equations of motion need:

- grad_i W is the gradient with respect to x_i, so grad_i W = F r_ij, r_ij = x_i - x_j, F = W'/r;
- L_ab = d v_a / d x_b;
- the artificial viscosity enters eq. 12 with a minus.

Index i is the first axis of a pair array, j the second. Tensors are 3 x 3 in 2-D too: the third
direction has no velocity and no gradient (plane strain), but it has a stress.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

FREE, FIXED = 0, 1
H = 2.5  # support radius of the kernel in smoothing lengths
UNIT = np.eye(3)
C_D = {2: 78 / (7 * np.pi), 3: 1365 / (64 * np.pi)}


def kernel(r: np.ndarray, h: np.ndarray, dim: int) -> np.ndarray:
    """Wendland C6 W(r, h) in 1/m^dim."""
    R = H * h
    s = np.minimum(r / R, 1)
    return C_D[dim] / R**dim * (1 - s) ** 8 * (1 + 8 * s + 25 * s**2 + 32 * s**3)


def gradient_factor(r: np.ndarray, h: np.ndarray, dim: int) -> np.ndarray:
    """F = W'(r, h) / r in 1/m^(dim+2); regular at r = 0."""
    R = H * h
    s = np.minimum(r / R, 1)
    return -22 * C_D[dim] / R ** (dim + 2) * (1 - s) ** 7 * (1 + 7 * s + 16 * s**2)


@dataclass(frozen=True)
class Options:
    """Parameters of the scheme, with the names and the defaults of a scenario."""

    eta: float = 1.2
    alpha: float = 1.0
    balsara: bool = True
    strength: bool = True
    tension: str = "clamp_fluid"  # "free", "clamp_fluid" or "clamp_all"
    h_mode: str = "constant"  # or "eq10"
    sym_grad: bool = False
    cflnumber: float = 0.1
    cfl_force: float = 0.1
    periodic: Sequence[bool] | None = None  # per axis; then the domain's corners are needed
    domain_min: Sequence[float] | None = None
    domain_max: Sequence[float] | None = None

    def of_core(self) -> dict[str, Any]:
        """What the core reads of them; whether there is strength, its materials say."""
        options = asdict(self)
        del options["strength"]
        return options


@dataclass(frozen=True)
class State:
    """What a step changes: x (N, dim), v (N, dim), rho (N,), S (N, 3, 3), h (N,), in SI units."""

    x: np.ndarray
    v: np.ndarray
    rho: np.ndarray
    S: np.ndarray
    h: np.ndarray


class Pairs:
    """Geometry of all ordered pairs: r_ij (N, N, dim), r (N, N), F_i = F(r, h_i) and F_j."""

    def __init__(self, x: np.ndarray, h: np.ndarray, box: np.ndarray) -> None:
        """`box` (dim,) holds the period of each axis, infinity where there is none."""
        dim = x.shape[1]
        self.r_ij = x[:, None] - x[None, :]
        periodic = np.isfinite(box)
        image = np.round(self.r_ij[..., periodic] / box[periodic])
        self.r_ij[..., periodic] -= image * box[periodic]
        self.r = np.sqrt((self.r_ij**2).sum(axis=-1))
        self.F_i = gradient_factor(self.r, h[:, None], dim)
        self.F_j = gradient_factor(self.r, h[None, :], dim)
        self.F_mean = (self.F_i + self.F_j) / 2
        self.near = (self.r > 0) & (self.r < H * np.maximum(h[:, None], h[None, :]))


class Reference:
    """A simulation of a few particles.

    `particles` has the arrays of doseki's ParticleSet; motion is FREE or FIXED. `materials` are
    objects with law ("fluid" or "solid"), rho0, speedsound, shear_modulus and nu, already scaled
    by xi. `gravity` (dim,) is in m/s2. `options` are those of Options. Raises ValueError for a
    motion that is neither, TypeError for an option that does not exist.
    """

    def __init__(
        self,
        particles: Any,
        materials: Sequence[Any],
        gravity: Sequence[float],
        options: Mapping[str, Any] | None = None,
    ) -> None:
        self.options = Options(**(options or {}))
        self.dim = particles.position.shape[1]
        self.gravity = np.asarray(gravity, dtype=float)
        self.mass = np.array(particles.mass, dtype=float)
        if not np.isin(particles.motion, (FREE, FIXED)).all():
            raise ValueError("the reference knows free and fixed particles only")
        self.fixed = np.asarray(particles.motion) == FIXED
        self._spread_materials([materials[k] for k in particles.material])
        self._set_domain()
        self.h_initial = np.array(particles.smoothing_length, dtype=float)
        self.state = State(
            x=np.array(particles.position, dtype=float),
            v=np.array(particles.velocity, dtype=float),
            rho=np.array(particles.density, dtype=float),
            S=np.zeros((len(self.mass), 3, 3)),
            h=self._smoothing_length(np.array(particles.density, dtype=float)),
        )
        self.time = 0.0
        self.step = 0
        self.step_rates = self.rates()

    def _spread_materials(self, material_of: Sequence[Any]) -> None:
        self.rho0 = np.array([m.rho0 for m in material_of])
        self.c0 = np.array([m.speedsound for m in material_of])
        self.nu = np.array([m.nu for m in material_of])
        self.fluid = np.array([m.law == "fluid" for m in material_of])
        mu = np.array([m.shear_modulus for m in material_of])
        elastic = ~self.fluid & ~self.fixed & self.options.strength
        self.mu = np.where(elastic, mu, 0.0)

    def _set_domain(self) -> None:
        periodic = self.options.periodic or (False,) * self.dim
        self.box = np.full(self.dim, np.inf)
        self.domain_min = np.zeros(self.dim)
        if any(periodic):
            self.domain_min = np.array(self.options.domain_min, dtype=float)
            length = np.array(self.options.domain_max, dtype=float) - self.domain_min
            self.box = np.where(periodic, length, np.inf)

    def rates(self, state: State | None = None) -> dict[str, Any]:
        """Everything the right-hand sides give at `state` (default: the present one).

        velocity_gradient (N, 3, 3) 1/s, density_rate (N,) kg/m3/s, deviatoric_stress_rate
        (N, 3, 3) Pa/s, acceleration (N, dim) m/s2, balsara (N,), max_signal_velocity (N,) m/s,
        pressure (N,) Pa, sound_speed (N,) m/s, stress (N, 3, 3) Pa, and the time step dt in s.
        """
        state = state or self.state
        pairs = Pairs(state.x, state.h, self.box)
        L = self._velocity_gradient(state, pairs)
        p, c = self._pressure(state.rho), self._sound_speed(state.rho)
        sigma = self._stress(state, p, L)
        f = self._balsara(L, c, state.h)
        w = self._approach(state.v, pairs)
        v_sig = c[:, None] + c[None, :] - 3 * w  # eq. 15
        a = self._acceleration(state.rho, sigma, pairs, self._viscosity(state.rho, f, w, v_sig))
        v_sig_max = np.maximum(2 * c, np.where(pairs.near, v_sig, 0).max(axis=1))
        return {
            "velocity_gradient": L,
            "density_rate": -state.rho * np.trace(L, axis1=1, axis2=2),  # eq. 11
            "deviatoric_stress_rate": self._deviatoric_stress_rate(state.S, L),
            "acceleration": a,
            "balsara": f,
            "max_signal_velocity": v_sig_max,
            "pressure": p,
            "sound_speed": c,
            "stress": sigma,
            "dt": self._time_step(state.h, v_sig_max, a),
        }

    def _velocity_gradient(self, state: State, pairs: Pairs) -> np.ndarray:
        """Eq. 9 for the dyadic product: L_ab = (1/rho_i) sum_j m_j (v_j - v_i)_a (grad_i W)_b."""
        v_ji = state.v[None, :] - state.v[:, None]
        F = pairs.F_mean if self.options.sym_grad else pairs.F_i
        L = np.zeros((len(self.mass), 3, 3))
        L[:, : self.dim, : self.dim] = np.einsum(
            "i,j,ija,ij,ijb->iab", 1 / state.rho, self.mass, v_ji, F, pairs.r_ij
        )
        return L

    def _pressure(self, rho: np.ndarray) -> np.ndarray:
        """Birch-Murnaghan, eq. 8, without the tension that the options or a fixed bed forbid."""
        e = rho / self.rho0
        p = 1.5 * self.rho0 * self.c0**2 * (e ** (7 / 3) - e ** (5 / 3))
        no_tension = {
            "free": self.fixed,
            "clamp_fluid": self.fixed | self.fluid,
            "clamp_all": np.ones_like(self.fixed),
        }[self.options.tension]
        return np.where(no_tension, np.maximum(p, 0), p)

    def _sound_speed(self, rho: np.ndarray) -> np.ndarray:
        """c^2 = dp/drho, eq. 17; dp/drho vanishes in strong tension, hence the floor."""
        e = rho / self.rho0
        squared = self.c0**2 / 2 * (7 * e ** (4 / 3) - 5 * e ** (2 / 3))
        return np.sqrt(np.maximum(squared, (0.1 * self.c0) ** 2))

    def _stress(self, state: State, p: np.ndarray, L: np.ndarray) -> np.ndarray:
        """Eqs. 3 and 6: -p E, plus S in a free solid, plus the viscous stress in a free fluid."""
        viscosity = np.where(self.fluid & ~self.fixed, state.rho * self.nu, 0)
        S = np.where((self.fluid | self.fixed)[:, None, None], 0, state.S)
        return -p[:, None, None] * UNIT + S + 2 * viscosity[:, None, None] * _deviator(L)  # eq. 7

    def _deviatoric_stress_rate(self, S: np.ndarray, L: np.ndarray) -> np.ndarray:
        """Eqs. 4 and 5: Hooke's law in the frame that turns with the material (Jaumann)."""
        spin = (L - L.transpose(0, 2, 1)) / 2
        rate = 2 * self.mu[:, None, None] * _deviator(L) + spin @ S - S @ spin
        return np.where((self.mu > 0)[:, None, None], rate, 0)

    def _balsara(self, L: np.ndarray, c: np.ndarray, h: np.ndarray) -> np.ndarray:
        if not self.options.balsara:
            return np.ones_like(c)
        div = np.abs(np.trace(L, axis1=1, axis2=2))
        curl = np.stack(
            [L[:, 2, 1] - L[:, 1, 2], L[:, 0, 2] - L[:, 2, 0], L[:, 1, 0] - L[:, 0, 1]], axis=1
        )
        return div / (div + np.linalg.norm(curl, axis=1) + 1e-4 * c / h)

    def _approach(self, v: np.ndarray, pairs: Pairs) -> np.ndarray:
        """w_ij of eq. 14 where particles approach each other, else 0."""
        v_ij = v[:, None] - v[None, :]
        distance = np.where(pairs.r > 0, pairs.r, 1)
        return np.minimum(0, (pairs.r_ij * v_ij).sum(axis=-1) / distance)

    def _viscosity(
        self, rho: np.ndarray, f: np.ndarray, w: np.ndarray, v_sig: np.ndarray
    ) -> np.ndarray:
        """Pi_ij of eqs. 13 and 16 times the mean of the Balsara factors."""
        rho_ij = (rho[:, None] + rho[None, :]) / 2
        f_ij = (f[:, None] + f[None, :]) / 2
        return -self.options.alpha * v_sig * w / (2 * rho_ij) * f_ij

    def _acceleration(
        self, rho: np.ndarray, sigma: np.ndarray, pairs: Pairs, Pi: np.ndarray
    ) -> np.ndarray:
        """Eq. 12; what is fixed does not accelerate."""
        d = self.dim
        stress = (sigma / rho[:, None, None] ** 2)[:, :d, :d]
        bracket = stress[:, None] + stress[None, :] - Pi[..., None, None] * np.eye(d)
        force = np.einsum("j,ijab,ij,ijb->ia", self.mass, bracket, pairs.F_mean, pairs.r_ij)
        return np.where(self.fixed[:, None], 0, force + self.gravity)

    def _time_step(self, h: np.ndarray, v_sig_max: np.ndarray, a: np.ndarray) -> float:
        """Eq. 18 over the particles that can move."""
        magnitude = np.maximum(np.linalg.norm(a, axis=1), np.finfo(float).tiny)
        dt = np.minimum(
            self.options.cflnumber * 2 * h / v_sig_max,
            self.options.cfl_force * np.sqrt(h / magnitude),
        )
        return float(dt[~self.fixed].min())

    def advance(self, until: float) -> None:
        """Steps until `until` in s; the last step is cut to end there exactly."""
        while self.time < until:
            last = self.time + self.step_rates["dt"] >= until
            dt = until - self.time if last else self.step_rates["dt"]
            self._step(dt)
            self.time = until if last else self.time + dt
            self.step += 1

    def _step(self, dt: float) -> None:
        """Kick, drift, kick: rates at the predicted state close this step and open the next."""
        moved = self._kicked(self.state, self.step_rates, dt / 2)
        x = self._wrapped(moved.x + np.where(self.fixed[:, None], 0, dt * moved.v))
        predicted = replace(self._kicked(self.state, self.step_rates, dt), x=x)
        predicted = replace(predicted, h=self._smoothing_length(predicted.rho))
        self.step_rates = self.rates(predicted)
        self.state = self._kicked(replace(moved, x=x, h=predicted.h), self.step_rates, dt / 2)

    def _kicked(self, state: State, rates: Mapping[str, Any], dt: float) -> State:
        """v, rho and S after dt at constant rates."""
        return replace(
            state,
            v=state.v + dt * rates["acceleration"],
            rho=state.rho + dt * rates["density_rate"],
            S=state.S + dt * rates["deviatoric_stress_rate"],
        )

    def _wrapped(self, x: np.ndarray) -> np.ndarray:
        periodic = np.isfinite(self.box)
        box = np.where(periodic, self.box, 1)
        shift = np.floor((x - self.domain_min) / box) * box
        return np.where(periodic, x - shift, x)

    def _smoothing_length(self, rho: np.ndarray) -> np.ndarray:
        """Eq. 10, bounded: h of a solid in tension would grow without end."""
        if self.options.h_mode == "constant":
            return self.h_initial
        h = self.options.eta * (self.mass / rho) ** (1 / self.dim)
        return np.clip(h, 0.8 * self.h_initial, 1.25 * self.h_initial)


def _deviator(L: np.ndarray) -> np.ndarray:
    """Strain rate D = (L + L^T)/2 without its isotropic part."""
    D = (L + L.transpose(0, 2, 1)) / 2
    return D - np.trace(D, axis1=1, axis2=2)[:, None, None] / 3 * UNIT
