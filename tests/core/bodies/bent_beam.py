"""Notched beams on two supports that are bent until they break; 2-D."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
from scipy.optimize import brentq

from .breaking import bodies_of
from .conftest import lattice

# Concrete (Petersson, Lund TVBM-1006, 1981; linear softening of the same strength and energy).
CONCRETE = {
    "rho0": 2400.0, "young_modulus": 30e9, "poisson_ratio": 0.2,
    "fracture": "cohesive", "tensile_strength": 3.33e6, "fracture_energy": 124.0,
}  # fmt: skip
CHARACTERISTIC = 0.335  # m, E G_f/f_t^2 of it


def published_peak(depth: float, span: float, notch: float, **material: float) -> float:
    """Highest load of a notched beam of 1 m across whose stress falls linearly with opening, N/m.

    Planas, Guinea and Elices (Int. J. Fract. 95, 1999), from which RILEM TC 187 finds the softening
    of concrete: notches of `notch` = 0.2 to 0.5 of the depth, spans of four depths.
    """
    strength = material["tensile_strength"]
    length = material["young_modulus"] * material["fracture_energy"] / strength**2
    size = (1 - notch**1.7) * depth / length

    def excess(x: float) -> float:
        return size * (11.2 / (x**2 - 1) ** 2 + 2.365 / x**2) - 1

    ligament = (1 - notch) * depth
    return 2 * strength / brentq(excess, 1 + 1e-6, 1e3) * ligament**2 / span


class Beam:
    """A notched beam as deep as E G_f/f_t^2 of its concrete, on a span of four depths.

    The lattice is turned by `lattice_angle` degrees, and shifted by `shift` spacings: on one that
    goes with the notch two equal cracks would start beside its tip.
    """

    depth = CHARACTERISTIC
    span = 4 * depth
    length = 4.5 * depth

    def __init__(
        self,
        core: ModuleType,
        across: int,
        lattice_angle: float = 20.0,
        shift: tuple[float, float] = (0.0, 0.0),
        notch: float = 0.5,
        turned: float = 0.0,
        mirrored: bool = False,
        **material: Any,
    ) -> None:
        self.material, self.spacing = CONCRETE | material, self.depth / across
        count = int(1.2 * self.length / self.spacing)
        points = lattice((count, count), self.spacing) + self.spacing * np.array(shift)
        x, y = (points @ rotation(-lattice_angle)).T
        inside = (np.abs(x) < 0.5 * self.length) & (np.abs(y) < 0.5 * self.depth)
        slit = np.abs(x) < 0.8 * self.spacing  # bonds are shorter than it is wide
        inside &= ~(slit & (y < (notch - 0.5) * self.depth))
        self.points = np.stack([x, y], axis=1)[inside]
        # A point is half a spacing high: so deep is what was cut.
        lowest = y[inside & slit].min() - 0.5 * self.spacing
        self.notch = max(0.0, lowest / self.depth + 0.5)
        self.frame = rotation(turned) @ np.diag([-1.0 if mirrored else 1.0, 1.0])
        places = np.ascontiguousarray(self.points @ self.frame.T)
        none = np.zeros(len(places), bool)
        self.bodies = bodies_of(core, places, self.spacing, none, **self.material)
        self.places, self.forces = places, self._forces()

    @property
    def published(self) -> float:
        """Its highest load as published, N/m."""
        return published_peak(self.depth, self.span, self.notch, **self.material)

    def _forces(self) -> np.ndarray:
        """On all points for a load of 1 N/m in the middle of the top, which two supports bear."""
        x, y = self.points.T
        share = np.zeros(len(x))
        half = 0.5 * self.span
        for at, side, load in ((0.0, 1, -1.0), (-half, -1, 0.5), (half, -1, 0.5)):
            rim = side * y > 0.5 * self.depth - 1.5 * self.spacing
            on = rim & (np.abs(x - at) < 0.06 * self.depth)
            # The force on these points goes through `at`.
            sums = np.stack([np.ones(on.sum()), (x[on] - at) / self.depth])
            share[on] += load * np.linalg.pinv(sums)[:, 0]
        return np.ascontiguousarray(np.outer(share, self.frame[:, 1]))

    def bend(self, slowness: float = 46.0) -> Beam:
        """Push its middle down until the load falls, while waves go along the span so many times.

        A soft spring with a dashpot between the beam and a grip that moves evenly: the load goes
        through its maximum as the beam lets it, and the beam does not swing.
        """
        young, ratio = self.material["young_modulus"], self.span / self.depth
        wave = np.sqrt(young / self.material["rho0"])
        elastic = 0.25 * self.published * ratio**3 / young  # deflection without notch and crack
        way, time = 14.0 * elastic, slowness * self.span / wave
        spring = young / ratio**3
        dashpot = 0.1 * np.sqrt(spring * 0.5 * self.material["rho0"] * self.depth * self.span)
        steps = int(time * wave / (1.5 * self.spacing)) + 1
        self.loads: list[float] = []
        for step in range(steps):
            state, part = self.bodies.state(), (step + 0.5) / steps
            sunk = float(((state["position"] - self.places) * self.forces).sum())
            speed = float((state["velocity"] * self.forces).sum())
            grip, pace = way * smooth_start(part), way / time * smooth_pace(part)
            ahead = sunk + 0.5 * speed * time / steps
            self.loads.append(spring * (grip - ahead) + dashpot * (pace - speed))
            self.bodies.set_load(self.loads[-1] * self.forces)
            self.bodies.advance(time / steps)
            if self.loads[-1] < 0.95 * self.peak and part > 0.3:
                break
        return self

    @property
    def peak(self) -> float:
        """Highest load so far, N/m."""
        return max(self.loads)


def rotation(degrees: float) -> np.ndarray:
    """(2, 2), counter-clockwise."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[cos, -sin], [sin, cos]])


RAMP = 0.1  # of the time, in which the grip gets under way


def smooth_pace(part: float) -> float:
    """Speed of the grip over the mean, at a part of the time."""
    return min(part / RAMP, 1.0) / (1 - 0.5 * RAMP)


def smooth_start(part: float) -> float:
    """How far the grip has come then, over its way."""
    gone = 0.5 * part**2 / RAMP if part < RAMP else part - 0.5 * RAMP
    return gone / (1 - 0.5 * RAMP)
