"""Bars that are pulled and discs that are pressed until they break."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from doseki.scenario.materials import ELASTIC_DEFAULTS

from .conftest import lattice

ROCK = {"rho0": 2600.0, "young_modulus": 50e9, "poisson_ratio": 0.2}
GRANITE = {"fracture": "cohesive", "tensile_strength": 10e6, "fracture_energy": 100.0}
WAVE = 4600.0  # m/s, of P waves in the rock
LEDGER = ("kinetic_energy", "strain_energy", "spring_energy", "fracture_work", "damping_work")


def bodies_of(
    core: ModuleType, rest: np.ndarray, spacing: float, clamped: np.ndarray, **material: Any
) -> Any:
    """One started body of rock, at rest."""
    bodies = getattr(core, f"ElasticBodies{rest.shape[1]}")()
    table = ELASTIC_DEFAULTS | ROCK | {"spacing": spacing} | material
    if table["fracture"] != "cohesive":
        del table["tensile_strength"], table["fracture_energy"]
    bodies.add(
        table,
        rest=np.ascontiguousarray(rest),
        position=np.ascontiguousarray(rest),
        velocity=np.zeros_like(rest),
        clamped=clamped.astype(np.uint8),
    )
    bodies.start()
    return bodies


def pieces(bodies: Any) -> list[int]:
    """How many points each piece has whose bonds hold, the largest first; single ones left out."""
    bonds, count = bodies.bonds(), len(bodies.state()["mass"])
    holds = bonds["intactness"] > 0
    pairs = (np.ones(holds.sum()), (bonds["a"][holds], bonds["b"][holds]))
    _, label = connected_components(coo_matrix(pairs, shape=(count, count)), directed=False)
    sizes = np.sort(np.bincount(label))[::-1]
    return [int(size) for size in sizes if size > 1]


def total(state: dict[str, Any]) -> float:
    """All energy: of motion and strain, and what cracks and damping took, J/m."""
    return float(sum(state[key] for key in LEDGER))


class Bar:
    """A bar 2 cm wide, held at one end and pulled at the other; a notch decides where it breaks.

    Its Poisson's ratio is 0, so that the clamps leave the stress even. `length` in m; `turn` is a
    rotation of the whole.
    """

    width = 0.02

    def __init__(
        self,
        core: ModuleType,
        across: int,
        rows_cut: int = 1,
        dim: int = 2,
        length: float = 0.05,
        turn: np.ndarray | None = None,
        **material: Any,
    ) -> None:
        self.material = GRANITE | {"poisson_ratio": 0.0} | material
        self.length, self.turn = length, np.eye(dim) if turn is None else turn
        spacing = self.width / across
        along = 2 * round(0.5 * self.length / spacing)
        points = lattice((along,) + (dim - 1) * (across,), spacing)
        sides = np.abs(points[:, 1:]) > 0.5 * self.width - (rows_cut + 0.01) * spacing
        points = points[~(sides.any(1) & (np.abs(points[:, 0]) < 0.75 * spacing))]
        end = np.abs(points[:, 0]).max() - 1.5 * spacing
        self.points, self.clamped = points, np.abs(points[:, 0]) > end
        self.area = (self.width - 2 * rows_cut * spacing) ** (dim - 1)
        placed = points @ self.turn.T
        self.bodies = bodies_of(core, placed, spacing, self.clamped, **self.material)
        self.rows: list[tuple[float, float, float]] = []

    @property
    def fracture_energy(self) -> float:
        """Of the crack, J, in 2-D J/m."""
        return self.material["fracture_energy"] * self.area

    def pull(self, by: float, slowness: float = 320.0, rows: int = 200) -> Bar:
        """Lengthen it by so much, m, while waves go through it `slowness` times."""
        time = slowness * self.length / WAVE
        velocity = np.zeros_like(self.points)
        share = np.clip(self.points[:, 0] / self.length + 0.5, 0, 1)
        velocity[:, 0] = np.where(self.clamped, np.round(share), share) * by / time
        self.bodies.set_velocity(velocity @ self.turn.T)
        for _ in range(rows):
            self.bodies.advance(time / rows)
            state = self.bodies.state()
            stress = (self.turn.T @ state["stress"] @ self.turn)[~self.clamped, 0, 0].mean()
            self.rows.append((stress, state["fracture_work"], total(state)))
        return self

    @property
    def stress(self) -> np.ndarray:
        """Mean stress along it, Pa."""
        return np.array(self.rows)[:, 0]

    @property
    def taken(self) -> float:
        """Energy that the crack took, J/m."""
        return self.rows[-1][1]

    def work_at(self, share: float) -> float:
        """The same when it was pulled by that share, J/m."""
        return self.rows[int(share * len(self.rows))][1]


class Disc:
    """A disc of 5 cm, pressed along y on two arcs of twice `arc` degrees (the Brazilian test).

    Its lattice is turned by `angle`, degrees; with `layers` it is a cylinder of so many of them.
    """

    diameter = 0.05

    def __init__(
        self,
        core: ModuleType,
        across: int,
        angle: float,
        arc: float = 8.0,
        layers: int = 0,
        **material: Any,
    ) -> None:
        self.arc, self.spacing = arc, self.diameter / across
        points = lattice((across + 4, across + 4), self.spacing)
        points = points[np.linalg.norm(points, axis=1) < 0.5 * self.diameter]
        turn = np.radians(angle)
        matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        self.points = points @ matrix.T
        self.depth = layers * self.spacing if layers else 1.0  # m
        if layers:
            along = np.repeat(lattice((layers,), self.spacing), len(points), axis=0)
            self.points = np.hstack([np.tile(self.points, (layers, 1)), along])
        self.material = material
        none = np.zeros(len(self.points), bool)
        self.bodies = bodies_of(core, self.points, self.spacing, none, **material)

    def press(self, slowness: float = 300.0, most: float = 1.2) -> Disc:
        """Load it ever more until it is split, at most `most` times what it should bear.

        The first 0.8 of the load come while waves cross it 30 times, what follows grows by all of
        what it should bear in `slowness` crossings: a crack takes some to run through.
        """
        self.load, crossing = 0.0, self.diameter / WAVE
        early = self._raise_load(0.0, 0.8, 30 * crossing, lambda t: t * t * (3 - 2 * t))
        if not early:
            self._raise_load(0.8, most, (most - 0.8) * slowness * crossing, lambda t: t)
        return self

    def _raise_load(
        self, start: float, end: float, time: float, course: Callable[[float], float]
    ) -> bool:
        """Whether it split while the load went between these parts of what it should bear."""
        face = 0.5 * np.pi * self.diameter * self.depth
        expected, steps = face * self.material["tensile_strength"], 300
        for step in range(steps):
            self.load = expected * (start + (end - start) * course((step + 0.5) / steps))
            self.bodies.set_load(self.load * self.pressed)
            self.bodies.advance(time / steps)
            if self.split > 0.8:
                return True
        return False

    @cached_property
    def pressed(self) -> np.ndarray:
        """Forces of a load of 1 N/m, on all points of the arcs.

        Those of an arc go through the middle of the disc: where the lattice is turned, equal ones
        would be a couple, and the disc would roll between the arcs.
        """
        x, y = self.points.T[:2]
        near = np.hypot(x, y) > 0.5 * self.diameter - 2 * self.spacing
        arc = near & (np.abs(np.degrees(np.arctan2(x, np.abs(y)))) < self.arc)
        force = np.zeros_like(self.points)
        for sign in (1, -1):
            on = arc & (sign * y > 0)
            sums = np.stack([np.ones(on.sum()), x[on] / self.diameter])
            force[on, 1] = -sign * np.linalg.pinv(sums)[:, 0]
        return force

    @property
    def broken(self) -> np.ndarray:
        """Middles of broken bonds at rest, m."""
        bonds = self.bodies.bonds()
        gone = bonds["intactness"] <= 0
        return 0.5 * (self.points[bonds["a"]] + self.points[bonds["b"]])[gone]

    @property
    def split(self) -> float:
        """Part of the loaded diameter, its ends left out, along which bonds are broken."""
        x, y = self.broken.T[:2]
        core = (np.abs(x) < 0.15 * self.diameter) & (np.abs(y) < 0.4 * self.diameter)
        rows = np.unique(np.round(y[core] / (2 * self.spacing)))
        return len(rows) * 2 * self.spacing / (0.8 * self.diameter)

    @property
    def strength(self) -> float:
        """2P/(pi d t) when it split, Pa."""
        return 2 * self.load / (np.pi * self.diameter * self.depth)

    @property
    def off_the_diameter(self) -> float:
        """Median distance of broken bonds from it, over the diameter."""
        return float(np.median(np.abs(self.broken[:, 0])) / self.diameter)
