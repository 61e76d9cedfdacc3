"""The resolved scheme written as plainly as possible: every pair is visited, nothing is clever.

An oracle for the core on small sets of particles. It shares no code with it. Arrays of pairs have
the particle i on their first axis, its neighbour on the second; r_ij = x_i - x_j and
grad_i W = F r_ij.
"Fluid" are the particles that move, "wall" the fixed ones. An evaluation sums for densities first,
with the pressure gradients, corrections of gradients, measures of the surface and shifting
velocities of the evaluation before, and then for forces, with what the first sums have given but
the pressure gradients of before. Nothing moves, so both see the same places and densities, and
nothing parts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

FIXED = 1
KAPPA = 0.4
SUPPORT = {"wendland_c2": 2.0, "wendland_c6": 2.5}
SURFACE, EDGE, ALONE = 0.9, 2.2, 3.0  # values of the measure of the free surface
LEAST_DEPTH = 1.5  # dp over which the pressure of the outermost row may fall
LEAST_CONCENTRATION = 0.6
ENOUGH_COMPANY = 0.05
FEW, SEVERAL = 1.2, 2.4  # neighbours
LEAST_BETA = 0.05  # of the Riemann dissipation
SMOOTH = 2.0  # times the approach that a resolved strain makes, below which that is no noise
RELAXATION, RELAXATION_AT_REST = 100.0, 1000.0  # of density, h/c
RELAXATION_PER_STRAIN = 10.0
TENSION_RELEASE = 10.0  # h/c
LEAST_DETERMINANT = 0.3  # of a moment, for corrected pressure
LARGEST_EXCESS = 0.5  # of a correction of gradients over 1
LEAST_DENSITY = 0.98  # rho0
EDGE_NOISE, EDGE_WHOLE = 0.15, 0.3  # share of what slides past an edge, Eq. (133)
LARGEST_TURN = 0.3  # of a wall's normal, Eq. (130)
LEAST_WEIGHT = 1e-9  # of fluid that a wall meets
LEAST_FILLED = 0.05  # of a rough wall's kernel
SHIFT_STRENGTH, SHIFT_MOST = 80.0, 10.0
SHIFT_FASTEST = 0.05  # over the sound speed
# Rate of the motion that viscosity damps most: shares of the sum of coefficients, of the largest.
ROUGHEST, NEAREST = 1.4, 0.6
STABLE = 0.9  # that rate over 1/dt
SHIFT_RATE = 0.0075  # at most, of the strain that drives it, over the time step of sound


@dataclass(frozen=True)
class FlowOptions:
    """Parameters of the scheme, with the names and the defaults of a scenario."""

    dp: float
    eta: float = 1.3
    kernel: str = "wendland_c2"
    viscosity: str = "stress"
    eos: str = "linear"
    turbulence: str = "none"
    smagorinsky: float = 0.12
    shifting: bool = True
    acoustic_damping: float = 0.05
    cflnumber: float = 0.5
    cfl_force: float = 0.25
    walls: Sequence[Mapping[str, Any]] = ({"no_slip": True, "ks": 0.0},)
    period: np.ndarray = field(default_factory=lambda: np.full(3, np.inf))


def kernel(name: str, r: np.ndarray, R: float, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """W in 1/m^dim and F = W'/r in 1/m^(dim+2), both zero beyond R."""
    q = np.minimum(r / R, 1)
    if name == "wendland_c2":
        scale = {2: 7 / np.pi, 3: 21 / (2 * np.pi)}[dim] / R**dim
        return scale * (1 - q) ** 4 * (1 + 4 * q), -20 * scale / R**2 * (1 - q) ** 3
    scale = {2: 78 / (7 * np.pi), 3: 1365 / (64 * np.pi)}[dim] / R**dim
    W = scale * (1 - q) ** 8 * (1 + 8 * q + 25 * q**2 + 32 * q**3)
    return W, -22 * scale / R**2 * (1 - q) ** 7 * (1 + 7 * q + 16 * q**2)


def lattice_sums(name: str, dp: float, R: float, dim: int) -> tuple[float, float]:
    """Sum of V W and of -V F x^2 over a lattice: 1 and 1 for an integral."""
    axis = dp * np.arange(-4, 5)
    x = np.array(list(product(axis, repeat=dim)))
    W, F = kernel(name, np.linalg.norm(x, axis=1), R, dim)
    return dp**dim * W.sum(), -(dp**dim) * (F * x[:, 0] ** 2).sum()


def lattice_concentration(options: FlowOptions, R: float, dim: int) -> tuple[float, float]:
    """Sum of V W over a lattice, and the part of it that the particle itself adds."""
    own, _ = kernel(options.kernel, np.zeros(1), R, dim)
    full, _ = lattice_sums(options.kernel, options.dp, R, dim)
    return full, options.dp**dim * own[0]


def dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Scalar product along the last axis."""
    return (u * v).sum(axis=-1)


def unit_or_zero(v: np.ndarray) -> np.ndarray:
    """Direction of each vector; zero for a vector of zero."""
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(length > 0, length, 1)


def tangential(v: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """The vectors without their parts along `direction` (of any length)."""
    n = unit_or_zero(direction)
    return v - dot(v, n)[..., None] * n


def largest_size(matrices: np.ndarray) -> np.ndarray:
    """Of eigenvalues: their mean and scatter bound it."""
    values = np.linalg.eigvalsh(matrices)
    return np.abs(values.mean(axis=1)) + np.sqrt(values.shape[1] - 1) * values.std(axis=1)


class Pairs:
    """Geometry of the pairs of fluid particles with others: r_ij, r, W and F (corrected)."""

    def __init__(self, x_i: np.ndarray, x_j: np.ndarray, options: FlowOptions) -> None:
        dim = x_i.shape[1]
        box = options.period[:dim]
        self.r_ij = x_i[:, None] - x_j[None, :]
        image = np.round(self.r_ij / box)
        self.r_ij -= image * np.where(np.isfinite(box), box, 0)
        self.r = np.linalg.norm(self.r_ij, axis=-1)
        R = SUPPORT[options.kernel] * options.eta * options.dp
        self.W, F = kernel(options.kernel, self.r, R, dim)
        self.F = F / lattice_sums(options.kernel, options.dp, R, dim)[1]
        self.safe_r = np.where(self.r > 0, self.r, 1)  # a particle with itself adds nothing


class FlowReference:
    """The right-hand side of the resolved scheme for a set of particles.

    `particles` has the arrays of doseki's ParticleSet and `normal`, `depth`, `curvature` of its
    walls, and `edge_normals`, `edge_depths` beside their edges; `materials` are mappings
    with law, rho0, speedsound, nu and, where they are not newtonian, rheology and its parameters.
    All smoothing lengths are eta dp, all fixed particles have no acceleration.
    """

    def __init__(
        self,
        particles: Any,
        materials: Sequence[Mapping[str, Any]],
        gravity: Sequence[float],
        options: FlowOptions,
    ) -> None:
        self.options, self.gravity = options, np.asarray(gravity, float)
        self.dim = particles.position.shape[1]
        self.h = options.eta * options.dp
        self.R = SUPPORT[options.kernel] * self.h
        self.c = max(m["speedsound"] for m in materials if m["law"] == "fluid")
        self.slowest, self.fastest = self.c / self.h / np.array([RELAXATION_AT_REST, RELAXATION])
        self._take_fluid(particles, materials)
        self._take_walls(particles)
        self.ff = Pairs(self.x, self.x, options)
        self.fw = Pairs(self.x, self.x_w, options)
        n = len(self.x)
        self.pressure_gradient = np.zeros((n, self.dim))
        self.L = np.zeros((n, self.dim, self.dim))
        self.surface, self.least_pressure = np.zeros(n), np.zeros(n)
        self.shift = np.zeros((n, self.dim))
        self.B = np.tile(np.eye(self.dim), (n, 1, 1))
        self.damping = np.zeros(n)
        self.bed_shear = np.zeros_like(self.v_w)
        self.stressed = options.viscosity == "stress"

    def _take_fluid(self, particles: Any, materials: Sequence[Mapping[str, Any]]) -> None:
        self.fluid = particles.motion != FIXED
        self.x, self.v = particles.position[self.fluid], particles.velocity[self.fluid]
        self.rho, self.mass = particles.density[self.fluid], particles.mass[self.fluid]
        of = [materials[k] for k in particles.material[self.fluid]]
        self.materials = of
        liquids = [m for m in materials if m["law"] == "fluid"]
        self.rheologies = {m.get("rheology") for m in liquids}
        viscosities = {m["rho0"] * m["nu"] for m in liquids}
        self.liquids_differ = self.rheologies <= {None, "newtonian"} and len(viscosities) > 1
        stiffest = max(m["rho0"] * m["speedsound"] ** 2 for m in liquids)
        self.cfl = min(
            self.options.cflnumber,
            2 * self.c * np.sqrt(min(m["rho0"] for m in liquids) / stiffest),
        )
        self.mean_pressure = np.zeros(len(self.x))
        self.rho0, self.c0, self.nu = (
            np.array([m[key] for m in of]) for key in ("rho0", "speedsound", "nu")
        )
        self.volume, self.rest_volume = self.mass / self.rho, self.mass / self.rho0

    def _take_walls(self, particles: Any) -> None:
        walls = ~self.fluid
        self.x_w, self.v_w = particles.position[walls], particles.velocity[walls]
        self.normal, self.depth = particles.normal[walls], particles.depth[walls]
        self.curvature = particles.curvature[walls]
        normals, depths = particles.edge_normals[walls], particles.edge_depths[walls]
        self.faces = np.zeros_like(normals)  # their normals, in rows
        self.faces[:, 0] = self.normal
        at_edge = normals.any(axis=(1, 2))
        self.faces[at_edge] = normals[at_edge]
        self.depths = np.where(at_edge[:, None], depths, 0)
        self.depths[~at_edge, 0] = self.depth[~at_edge]
        condition = [self.options.walls[k] for k in particles.body[walls]]
        self.stick = np.array([float(c["no_slip"]) for c in condition])
        self.ks = np.array([c["ks"] for c in condition])
        self.V_w = self.options.dp**self.dim

    def start(self) -> FlowReference:
        """What the core does before its first step: two evaluations."""
        self.evaluate()
        self.evaluate()
        return self

    def evaluate(self) -> None:
        """Rates from the state and from what the evaluation before has left."""
        self._continuity_pass()
        self._force_pass()

    def _see(self) -> dict[str, np.ndarray]:
        """Pressures and viscosities as pairs see them; what walls and fluid make of each other."""
        p = self._pressure(self.surface)
        self.p = p + self.damping
        self.mu = self._molecular_viscosity() + self.rho * self._eddy_viscosity()
        self.resolved = self._resolved_strain(self.mu)
        return self._contact()

    def _pressure(self, surface: np.ndarray) -> np.ndarray:
        """Linear or Tait's law; little tension on a free surface."""
        p = self._of_density(self.rho / self.rho0)
        return np.where(surface > SURFACE, np.maximum(p, self.least_pressure), p)

    def _take_least_pressure(self) -> None:
        """Of the outermost row, where the pressure falls inwards; spray and corners have none."""
        inwards = unit_or_zero(self.concentration_gradient)
        slope = np.minimum(dot(self.pressure_gradient, inwards), 0)
        row = (self.measure > SURFACE) & (self.measure < EDGE)
        self.least_pressure = np.where(row, LEAST_DEPTH * self.options.dp * slope, 0)

    def _of_density(self, e: np.ndarray) -> np.ndarray:
        """Pressure of a density over that at rest."""
        stiffness = self.rho0 * self.c0**2
        return stiffness * (e - 1) if self.options.eos == "linear" else stiffness / 7 * (e**7 - 1)

    def _damping_pressure(self) -> np.ndarray:
        """Of the acoustic damper: none on a surface, no tension that the liquid cannot bear."""
        divergence = np.trace(self.L, axis1=1, axis2=2)
        fluid = (self.rest_volume[None] * self.ff.W).sum(axis=1)
        first_row = np.minimum(self.share_of_walls / (fluid + self.share_of_walls) / 0.2, 1)
        alpha = self.options.acoustic_damping
        alpha = np.maximum(alpha, np.minimum(alpha * (1 + 3 * first_row), 0.2))
        added = -alpha * self.rho * self.c * self.h * divergence
        least = self._of_density(np.where(self._vented(), 1.0, LEAST_DENSITY))
        added = np.maximum(added, np.minimum(0, least - (self.p - self.damping)))
        return np.where(self.surface > SURFACE, 0.0, added)

    # Viscosity

    def _strain_rate(self) -> np.ndarray:
        """sqrt(2 D:D)."""
        D = 0.5 * (self.L + self.L.transpose(0, 2, 1))
        return np.sqrt(2 * (D**2).sum(axis=(1, 2)))

    def _molecular_viscosity(self) -> np.ndarray:
        """rho nu, or the stress of a rheology over the rate of strain."""
        mu = self.rho * self.nu
        for i, (m, rate) in enumerate(zip(self.materials, self._strain_rate(), strict=True)):
            if m.get("rheology") == "herschel_bulkley":
                rate = max(rate, 1e-9)
                stress = m["yield_stress"] * -np.expm1(-m["regularisation"] * rate)
                stress += m["consistency"] * rate ** m["flow_index"]
                mu[i] = min(stress / rate, m["viscosity_max"])
            elif m.get("rheology") == "mu_i":
                p, rate = max(self.mean_pressure[i], 1e-300), max(rate, 1e-9)
                inertial = rate * m["grain_diameter"] / np.sqrt(p / m["grain_density"])
                growth = (m["mu_2"] - m["mu_s"]) / (m["inertial_number"] / inertial + 1)
                mu[i] = min((m["mu_s"] + growth) * p / rate, m["viscosity_max"])
        return mu

    def _resolved_strain(self, mu: np.ndarray) -> np.ndarray:
        """The rate of strain, as far as viscosity is what counts over a smoothing length."""
        rate = self._strain_rate()
        resolved = rate * mu / (mu + 0.1 * self.rho * rate * self.h**2 + 1e-300)
        return np.where(self.surface > SURFACE, 0.0, resolved)

    def _eddy_viscosity(self) -> np.ndarray:
        """Square of the mixing length times sqrt(2 D:D)."""
        if self.options.turbulence == "none":
            return np.zeros(len(self.x))
        least = self.options.smagorinsky * self.options.dp
        mixing = self.options.turbulence == "mixing_length"
        length = self._mixing_length(least) if mixing else least
        return length**2 * self._strain_rate()

    def _mixing_length(self, least: float) -> np.ndarray:
        """kappa z sqrt(1 - z/d) with bed and depth of the column of plan in which a particle is.

        Columns are about 4 dp wide; whole ones fill a period.  Only what faces upwards is a bed.
        """
        period = self.options.period[: self.dim - 1]
        whole = np.maximum(np.floor(period / (4 * self.options.dp)), 1)
        bounded = np.where(np.isfinite(period), period, 0)
        width = np.where(bounded > 0, bounded / whole, 4 * self.options.dp)
        column, of_wall = (np.floor(x[:, :-1] / width) for x in (self.x, self.x_w))
        length = np.full(len(self.x), least)
        for i, key in enumerate(column):
            here = (column == key).all(axis=1)
            bed = (of_wall == key).all(axis=1) & (self.normal[:, -1] >= 0.5)
            top = (self.x_w[:, -1] + self.depth)[bed]
            below = top < self.x[here, -1].mean()
            top = top[below]
            if len(top):
                d = self.volume[here].sum() / width.prod()
                z = np.clip(self.x[i, -1] - top.max(), 0, d)
                z0 = self.ks[np.flatnonzero(bed)[below]].max() / 30
                length[i] = max(least, KAPPA * (z + z0) * np.sqrt(1 - z / d))
        return length

    # Walls

    def _contact(self) -> dict[str, np.ndarray]:
        """What a fluid particle i and a wall particle w make of each other."""
        pairs, dp = self.fw, self.options.dp
        n, depth, g_normal, in_front, beyond_edge = self._faces()
        foot = self._normal_at_foot(n, in_front)
        r_n, v = dot(pairs.r_ij, n), self.v[:, None] - self.v_w[None]
        approach = -dot(v, n)
        pulled = beyond_edge & (approach < 0)
        approach = np.where(pulled, 0, approach)
        # Pressure of the wall over that of i: gravity across it, the fluid's gradient along it.
        gradient = self.pressure_gradient[:, None]
        along = pairs.r_ij - (in_front * r_n)[..., None] * n
        weight = self.rho[:, None] * g_normal * r_n
        excess = np.maximum(weight, np.minimum(0, -self.p[:, None])) - dot(gradient, along)
        smooth = self.resolved[:, None] * pairs.r
        solved = np.where(pulled, 0, -2 * dot(v, foot))
        extra = self._dissipation(solved, self.rho[:, None], smooth)
        vented = (self.surface > SURFACE)[:, None]
        extra = np.where(vented, np.maximum(extra, np.minimum(0, -self.p[:, None])), extra)
        across = r_n[..., None] * foot
        p = self.p[:, None] + 0.5 * excess
        corrected_r = np.einsum("iab,iwb->iwa", self.B, pairs.r_ij)
        factor = self.stick * (1 + depth / np.maximum(r_n - depth, dp / 4))
        past_edge = v + approach[..., None] * n
        sliding = v - np.where(pulled, 0, dot(v, foot))[..., None] * foot
        mu = (self.mu[:, None] * factor)[..., None]
        layer = 0.1 * self.rho[:, None] * np.linalg.norm(sliding, axis=-1) * dp
        resolved = self.mu[:, None] / (self.mu[:, None] + layer)
        steep = (1 - self.stick * resolved) * in_front * r_n / np.maximum(r_n - depth, dp / 4)
        scale = -2 * self.V_w * pairs.F
        across_wall = self._stress_across_walls(foot, in_front)
        sheared = mu * sliding + across_wall[..., None] * foot
        mu_across = self.stressed * (1 - self.stick) * in_front * self.mu[:, None]
        return {
            "force": scale[..., None]
            * (p[..., None] * corrected_r + extra[..., None] * across - sheared),
            "excess": excess,
            "height": r_n - depth,
            "v_dot_r": -2 * approach * dot(corrected_r, n),
            "viscous_rate": scale * (mu[..., 0] + 2 * mu_across),
            "sliding_dot_r": 2 * dot(past_edge, corrected_r),
            "sliding_size": 2 * np.linalg.norm(v, axis=-1) * pairs.r,
            "jump": (resolved * factor)[..., None] * sliding
            + steep[..., None] * self.bed_shear
            + 2 * (v - sliding),
            "power": scale * (dot(sheared, v) - extra * dot(across, v)),
        }

    def _stress_across_walls(self, normal: np.ndarray, in_front: np.ndarray) -> np.ndarray:
        """mu n.2D r of each pair, where the stress is that of the strain."""
        D = 0.5 * (self.L + self.L.transpose(0, 2, 1))
        strained = np.einsum("iab,iwb->iwa", 2 * D, self.fw.r_ij)
        share = self.stressed * (1 - self.stick) * in_front
        return share * self.mu[:, None] * dot(normal, strained)

    def _faces(self) -> tuple[np.ndarray, ...]:
        """Normal, depth and part of gravity of a wall as seen by the fluid; whether that is in
        front of a face, and whether beyond an edge, in front of several.
        """
        r = self.fw.r_ij
        out = np.einsum("wka,iwa->iwk", self.faces, r) - (1 - 1e-4) * self.depths
        front = out > 0
        alone, beyond = front.sum(axis=-1) == 1, front.sum(axis=-1) > 1
        way = np.einsum("iwk,wka->iwa", np.where(front, out, 0), self.faces)
        distance = np.linalg.norm(way, axis=-1)
        way = way / np.where(beyond, distance, 1)[..., None]
        own = front[..., None]
        g = -self.faces @ self.gravity
        n = np.where(
            alone[..., None], (own * self.faces).sum(axis=2), r / self.fw.safe_r[..., None]
        )
        n = np.where(beyond[..., None], way, n)
        depth = np.where(alone, (front * self.depths).sum(axis=-1), self.depths[:, 0])
        depth = np.where(beyond, dot(r, way) - distance, depth)
        share = (
            np.where(beyond[..., None], front * out, 0) / np.where(beyond, distance, 1)[..., None]
        )
        share = np.where(alone[..., None], front, share)
        return n, depth, (share * g).sum(axis=-1), alone | beyond, beyond

    def _normal_at_foot(self, n: np.ndarray, in_front: np.ndarray) -> np.ndarray:
        """The wall's normal where the fluid particle stands over it; balls turn it."""
        r = self.fw.r_ij
        turn = self.curvature[:, None] * (r - dot(r, n)[..., None] * n)
        turn = np.where(in_front[..., None], turn, 0)
        size = np.linalg.norm(turn, axis=-1, keepdims=True)
        turned = n + turn * LARGEST_TURN / np.maximum(size, LARGEST_TURN)
        return turned / np.linalg.norm(turned, axis=-1, keepdims=True)

    def _dissipation(self, approach: np.ndarray, rho: np.ndarray, smooth: np.ndarray) -> np.ndarray:
        """What the Riemann solver adds to the mean pressure; a smooth flow has no least beta."""
        sizes = approach**2 + (SMOOTH * smooth) ** 2
        least = LEAST_BETA * approach**2 / np.maximum(sizes, 1e-300)
        beta = np.minimum(np.maximum(3 * approach / self.c, least), 1)
        return 0.5 * beta * rho * self.c * approach

    def _wall_pass(self, contact: Mapping[str, np.ndarray]) -> None:
        """Force, pressure and friction of the walls; `traction` is what rough ones hand back."""
        share = self.volume[:, None] * self.fw.W
        weight = share.sum(axis=0)
        filled = np.where(weight > 0, weight, 1)
        self.wall_force = -(self.volume[:, None, None] * contact["force"]).sum(axis=0)
        p_w = self.p[:, None] + contact["excess"]
        self.wall_pressure = np.where(weight > 0, (share * p_w).sum(axis=0) / filled, 0)
        u = (share[..., None] * self.v[:, None]).sum(axis=0) / filled[:, None] - self.v_w
        u = tangential(u, self.normal)
        dp, ks = self.options.dp, np.where(self.ks > 0, self.ks, 1)
        rough = (self.ks > 0) & (self.depth < dp) & (weight > LEAST_FILLED)
        z = np.maximum((share * contact["height"]).sum(axis=0) / filled, ks / 30)
        rho = (share * self.rho[:, None]).sum(axis=0) / filled
        turbulent = rho * (KAPPA / np.log(1 + 30 * z / ks)) ** 2 * np.linalg.norm(u, axis=1)
        steep = 30 * z / ks / ((1 + 30 * z / ks) * np.log(1 + 30 * z / ks))
        mu = (share * self.mu[:, None]).sum(axis=0) / filled
        height = np.maximum((share * contact["height"]).sum(axis=0) / filled, 0.25 * dp)
        viscous = self.stick * mu / height
        added = np.maximum(turbulent - viscous, 0)
        meets = (self.ks > 0) & (weight > LEAST_WEIGHT) & (added > 0)
        share = np.where(meets, added, 0) / np.where(meets, turbulent, 1)
        self.bed_shear = (share * steep)[:, None] * u
        drag = np.where(rough, added, 0)[:, None] * u
        drag *= dp ** (self.dim - 1)
        self.wall_force += drag
        self.power_to_rough_walls = dot(drag, self.v_w).sum()
        self.traction = -drag / filled[:, None]

    # Fluid

    def _continuity_pass(self) -> None:
        contact = self._see()
        self.share_of_walls = (self.V_w * self.fw.W).sum(axis=1)
        self._take_gradients(contact)
        self._measure_surface()
        rate, power = self._sums_for_density()
        rate += (self.V_w * self.fw.F * contact["v_dot_r"]).sum(axis=1)
        of_pairs = rate.copy()
        rate += self._edge_rate(contact)
        self.density_rate = self.rho * rate + dot(self.pressure_gradient, self.shift) / self.c0**2
        self._relax_density()
        self._set_shift()
        self._correct_pressure()
        self.surface = self.measure
        self._take_least_pressure()
        self.damping = self._damping_pressure()
        self.power = (self.volume * (power + self.damping * of_pairs)).sum()

    def _force_pass(self) -> None:
        never = self.mean_pressure == 0
        self.mean_pressure = np.where(never, self._pressure(self.surface), self.mean_pressure)
        contact = self._see()
        self._wall_pass(contact)
        force, power = self._sums_for_force()
        self._take_pressure_gradient(contact)
        drag = (self.fw.W[..., None] * self.traction).sum(axis=1)
        force += contact["force"].sum(axis=1) + drag
        power += contact["power"].sum(axis=1) - dot(drag, self.v)
        self.power += (self.volume * power).sum() - self.power_to_rough_walls
        self.acceleration = force / self.rho[:, None] + self.gravity
        self.viscous_rate = self._viscous_rate() + contact["viscous_rate"].sum(axis=1) / self.rho
        self._set_timestep()

    def _sums_for_density(self) -> tuple[np.ndarray, np.ndarray]:
        """Density rate over density, and the power over volume that it takes, of fluid pairs."""
        pairs, VF = self.ff, self.volume[None] * self.ff.F
        v, rho = self.v[:, None] - self.v[None], self._mean(self.rho)
        corrected_r = np.einsum("jab,ijb->ija", self.B, pairs.r_ij)
        jump = self.p[:, None] - self.p[None]
        jump = jump - dot(self._mean(self.pressure_gradient), pairs.r_ij)
        levelled = 0.5 * jump * pairs.r / (rho * self.c)
        rate = (VF * (dot(v, corrected_r) + levelled)).sum(axis=1)
        levelling = 0.5 * levelled * (self.p[:, None] - self.p[None])
        return rate, -(VF * levelling).sum(axis=1)

    def _sums_for_force(self) -> tuple[np.ndarray, np.ndarray]:
        """Force and power over volume of fluid pairs."""
        pairs, VF = self.ff, self.volume[None] * self.ff.F
        v = self.v[:, None] - self.v[None]
        v_r, rho = dot(v, pairs.r_ij), self._mean(self.rho)
        D = 0.5 * (self.L + self.L.transpose(0, 2, 1))
        smooth = np.einsum("ijab,ija,ijb->ij", self._mean(D), pairs.r_ij, pairs.r_ij)
        resolved = np.minimum(self.resolved[:, None], self.resolved[None])
        extra = self._dissipation((smooth - v_r) / pairs.safe_r, rho, resolved * pairs.r)
        corrected_r = np.einsum("jab,ijb->ija", self.B, pairs.r_ij)
        reverse = self.p[:, None, None] * corrected_r
        pressure = reverse - reverse.transpose(1, 0, 2)  # r_ji = -r_ij
        viscous = self._pair_viscosity()[..., None] * self._viscous_direction(v, v_r)
        force = -(VF[..., None] * pressure).sum(axis=1)
        force -= 2 * (VF[..., None] * (extra[..., None] * pairs.r_ij - viscous)).sum(axis=1)
        force += self._exchange(rho)
        return force, (VF * (extra * v_r - dot(viscous, v))).sum(axis=1)

    def _pair_viscosity(self) -> np.ndarray:
        mean = self._mean(self.mu)
        if "herschel_bulkley" in self.rheologies or self.liquids_differ:
            return self.mu[:, None] * self.mu[None] / mean
        if "mu_i" in self.rheologies:
            rate = self._strain_rate() + 1e-12
            return self._mean(self.mu * rate) / self._mean(rate)
        return mean

    def _viscous_rate(self) -> np.ndarray:
        """At which viscosity among fluid damps neighbours that go against each other."""
        central = self.options.viscosity == "monaghan_cleary"
        along = (self.dim + 2) * {2: 0.7, 3: 0.5}[self.dim] if central else 1
        VF = self.volume[None] * self.ff.F * (self.ff.r > 0)
        pairs = -VF * self._pair_viscosity()
        rate = ROUGHEST * pairs.sum(axis=1) + NEAREST * pairs.max(axis=1)
        return 2 * along * rate / self.rho

    def _exchange(self, rho: np.ndarray) -> np.ndarray:
        """Force over volume by which neighbours make up for each other's shifting."""
        carried = np.einsum("iab,ib->ia", self.L, self.shift)
        full, own = lattice_concentration(self.options, self.R, self.dim)
        weight = rho * self.volume[None] * self.ff.W / (full - own)
        return (weight[..., None] * (carried[:, None] - carried[None])).sum(axis=1)

    def _mean(self, a: np.ndarray) -> np.ndarray:
        return 0.5 * (a[:, None] + a[None])

    def _viscous_direction(self, v: np.ndarray, v_r: np.ndarray) -> np.ndarray:
        r = self.ff.r_ij
        if self.options.viscosity == "monaghan_cleary":
            return ((self.dim + 2) * v_r / self.ff.safe_r**2)[..., None] * r
        if self.options.viscosity == "morris":
            return v
        return v + np.einsum("ijab,ija->ijb", self._mean(self.L), r)

    def _take_gradients(self, contact: Mapping[str, np.ndarray]) -> None:
        """Corrected gradient of velocity, and the plain one of concentration."""
        VF_f, VF_w = self.volume[None] * self.ff.F, self.V_w * self.fw.F
        r_f, r_w = self.ff.r_ij, self.fw.r_ij
        moment = -np.einsum("ij,ija,ijb->iab", VF_f, r_f, r_f)
        moment -= np.einsum("ij,ija,ijb->iab", VF_w, r_w, r_w)
        spans = np.linalg.det(moment) > 0.05
        self.inverse = np.zeros_like(moment)
        self.inverse[spans] = np.linalg.inv(moment[spans])
        v_ij = self.v[:, None] - self.v[None]
        L = -np.einsum("ij,ija,ijb->iab", VF_f, v_ij, r_f)
        L -= np.einsum("ij,ija,ijb->iab", VF_w, contact["jump"], r_w)
        self.moment, self.spans = moment, np.linalg.det(moment) > LEAST_DETERMINANT
        self.L = np.einsum("ibc,iac->iab", self.inverse, L)
        self.concentration_gradient = np.einsum("ij,ija->ia", VF_f, r_f)
        self.concentration_gradient += np.einsum("ij,ija->ia", VF_w, r_w)

    def _take_pressure_gradient(self, contact: Mapping[str, np.ndarray]) -> None:
        VF_f, VF_w = self.volume[None] * self.ff.F, self.V_w * self.fw.F
        plain = -np.einsum("ij,ij,ija->ia", VF_f, self.p[:, None] - self.p[None], self.ff.r_ij)
        plain += np.einsum("ij,ij,ija->ia", VF_w, contact["excess"], self.fw.r_ij)
        self.pressure_gradient = np.einsum("iab,ib->ia", self.inverse, plain) * self._company()

    def _company(self) -> np.ndarray:
        """(n, 1): 0 for who sees no more than one neighbour: walls tell it nothing but gravity."""
        full, _ = lattice_concentration(self.options, self.R, self.dim)
        share = self.rest_volume[None] * self.ff.W
        np.fill_diagonal(share, 0)
        others, squares = share.sum(axis=1), (share**2).sum(axis=1)
        neighbours = np.divide(others**2, squares, out=np.zeros_like(others), where=squares > 0)
        enough = np.clip(others / (ENOUGH_COMPANY * full), 0, 1)
        return (enough * np.clip((neighbours - FEW) / (SEVERAL - FEW), 0, 1))[:, None]

    def _measure_surface(self) -> None:
        """Measure of the free surface, and how full the fluid is regardless of it."""
        full, _ = lattice_sums(self.options.kernel, self.options.dp, self.R, self.dim)
        C = ((self.rest_volume[None] * self.ff.W).sum(axis=1) + self.share_of_walls) / full
        slope = self.R * np.linalg.norm(self.concentration_gradient, axis=1)
        spray = C < LEAST_CONCENTRATION
        x = np.where(spray, ALONE, np.minimum(slope / np.where(spray, 1, C), ALONE))
        a, b = (0.045, 0.047) if self.options.kernel == "wendland_c6" else (0.053, 0.086)
        self.filling = np.where((x < EDGE) & ~spray, C * (1 + a * x + b * x**2), 1)
        self.measure = x
        self.nearby = np.where(self.ff.F < 0, self.surface[None], 0).max(axis=1)

    def _correct_pressure(self) -> None:
        """Inverse moments inside the fluid and at walls, none near the surface."""
        self.inside = (np.maximum(self.nearby, self.measure) < SURFACE) & self.spans
        self.B = np.tile(np.eye(self.dim), (len(self.x), 1, 1))
        excess = np.linalg.inv(self.moment[self.inside]) - np.eye(self.dim)
        share = LARGEST_EXCESS / np.maximum(largest_size(excess), LARGEST_EXCESS)
        self.B[self.inside] += share[:, None, None] * excess

    def _edge_rate(self, contact: Mapping[str, np.ndarray]) -> np.ndarray:
        """Expansion of what slides past edges of walls; smaller parts are noise."""
        weight = self.V_w * self.fw.F
        rate = (weight * contact["sliding_dot_r"]).sum(axis=1)
        size = -(weight * contact["sliding_size"]).sum(axis=1)
        share = np.abs(rate) / np.maximum(size, 1e-300)
        self.past_edge = share > EDGE_NOISE
        return rate * np.clip((share - EDGE_NOISE) / (EDGE_WHOLE - EDGE_NOISE), 0, 1)

    def _set_shift(self) -> None:
        """The velocity relative to the fluid with which particles move next."""
        self.shift = np.zeros((len(self.x), self.dim))
        if not self.options.shifting:
            return
        most = SHIFT_RATE * self.c / (self.cfl * self.h)
        rate = np.minimum(np.sqrt((self.L**2).sum(axis=(1, 2))), most)
        slope = np.linalg.norm(self.concentration_gradient, axis=1)
        speed = np.minimum(SHIFT_STRENGTH * self.h * slope, SHIFT_MOST) * self.h * rate
        shift = -speed[:, None] * unit_or_zero(self.concentration_gradient)
        surface_gradient = np.einsum(
            "ij,ij,ija->ia",
            self.volume[None] * self.ff.F,
            self.surface[None] - self.surface[:, None],
            self.ff.r_ij,
        )
        near_surface = (self.nearby > SURFACE)[:, None]
        shift = np.where(near_surface, tangential(shift, surface_gradient), shift)
        speed = np.linalg.norm(shift, axis=1)[:, None]
        shift = shift * np.minimum(1, SHIFT_FASTEST * self.c / np.maximum(speed, 1e-300))
        self.shift = np.where((self.measure < SURFACE)[:, None], shift, 0)

    def _relax_density(self) -> None:
        strain = np.sqrt((self.L**2).sum(axis=(1, 2)))
        rate = RELAXATION_PER_STRAIN * strain
        self.relaxation = np.clip(rate, self.slowest, self.fastest)
        spray = self.measure >= ALONE  # eq. 147: not compressed before its particles are together
        self.density_rate = np.where(spray, np.minimum(self.density_rate, 0), self.density_rate)
        self.density_rate += self.relaxation * (self.filling * self.rho0 - self.rho)
        vented = self._vented()
        least = np.where(vented, 1.0, LEAST_DENSITY) * self.rho0
        release = (least - self.rho) * self.c / (TENSION_RELEASE * self.h)
        bounded = np.maximum(self.density_rate, np.where(vented, release, 0))
        self.density_rate = np.where(self.rho < least, bounded, self.density_rate)

    def _vented(self) -> np.ndarray:
        """Where air comes in: what has a free surface slides past an edge of a wall."""
        return self.past_edge & (self.nearby > SURFACE)

    def _set_timestep(self) -> None:
        reach = SUPPORT[self.options.kernel] * self.h
        gradient = np.linalg.norm(self.L, axis=(1, 2))
        speed = np.minimum(np.linalg.norm(self.v, axis=1), reach * gradient)
        force = np.linalg.norm(self.acceleration, axis=1)
        limits = [
            self.cfl * self.h / (self.c + speed),
            self.options.cfl_force * np.sqrt(self.h / force),
            STABLE / np.maximum(self.viscous_rate, 1e-300),
        ]
        self.timestep = np.min(limits)
