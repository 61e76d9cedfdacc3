"""What bodies of every shape have in common: particles at rest, and walls."""

from __future__ import annotations

from typing import Generic, TypeVar

import numpy as np
from scipy.spatial import cKDTree

from ...record.particles import BOUND, FIXED, FREE, ParticleSet
from ...scenario.materials import NO_FRACTURE
from ...scenario.tables.body import ShapedBody
from ..bodies import ElasticBody, ElasticSurface, balls_around
from ..groups import UPRIGHT, Group, matrices
from ..meshes.cells import Cells, cells_of
from ..periodic import wrapped
from ..shapes import Convex, Edges, Particles, PlaneFaces, Shape
from ..shapes.surface import shared_among
from .body import Body

S = TypeVar("S", bound=ShapedBody)


class Shaped(Body[S], Generic[S]):
    """A body with a shape."""

    @property
    def rho0(self) -> float:
        """Density of its material at rest, kg/m3."""
        return self.scenario.materials[self.table.material].rho0

    def fill(self) -> tuple[np.ndarray, float]:
        """Positions (N, dim) of particles that are no parts of bodies, and the mass of each."""
        raise NotImplementedError

    def missing_density(self, n: int) -> np.ndarray:
        """Density (N,) that what is yet to cover the body will add to that of its particles."""
        return np.zeros(n)

    def particles(self, names: list[str]) -> ParticleSet:
        """Its particles at reference density, or at that of the initial pressure."""
        position, mass = self.fill()
        n = len(position)
        masses, rest = np.full(n, mass), np.full(n, self.rho0)
        compressed = 1 + self._compression(position)
        return ParticleSet(
            position=position,
            velocity=self.velocity_at(position),
            mass=masses * compressed,
            density=rest * compressed - self.missing_density(n),
            smoothing_length=self.scenario.smoothing_length(masses, rest),
            motion=np.full(n, FIXED if self.table.fixed else FREE, np.int32),
            **self._indices(names, n),
        )

    def _indices(self, names: list[str], n: int) -> dict[str, np.ndarray]:
        """What names n particles of the body."""
        material = self.scenario.material_names.index(self.table.material)
        return {
            "material": np.full(n, material, np.int32),
            "body": np.full(n, names.index(self.name), np.int32),
            "id": np.arange(n, dtype=np.int64),
        }

    def _compression(self, position: np.ndarray) -> np.ndarray:
        """rho/rho0 - 1 of the initial pressure, p = c^2 (rho - rho0) with the c of the run."""
        if self.table.pressure is None:
            return np.zeros(len(position))
        pressure = self.values_at("pressure", self.table.pressure, position)
        scaled = self.scenario.materials[self.table.material].scaled(self.scenario.xi)
        stiffness = scaled.rho0 * scaled.speedsound**2  # Pa
        if (pressure <= -stiffness).any():
            raise self.error(
                f".pressure: {pressure.min():.4g} Pa is more tension than "
                f"rho0 c^2 = {stiffness:.4g} Pa allows",
                "pressure",
            )
        return pressure / stiffness

    def single_group(
        self, shape: Shape, centre: np.ndarray, orientation: np.ndarray = UPRIGHT
    ) -> Group:
        """A body of one piece."""
        return Group(
            self.name,
            [shape],
            np.zeros(1, np.int32),
            centre[None, :],
            orientation[None, :],
            self.table.material,
            self.kinematics,
        )

    def faces(self) -> np.ndarray | None:
        """See Body: those of a convex body."""
        if not self.is_of_bodies:
            return None
        group = self.group()
        shape = group.shapes[0]
        if not isinstance(shape, Convex) or len(group) != 1:
            return None
        turn = matrices(group.orientation, self.dim)[0]
        corners: np.ndarray = shape.vertices[shape.faces]
        return np.asarray(group.centre[0] + corners @ turn.T)

    def plane_faces(self) -> PlaneFaces | None:
        """See Body: those of a convex body."""
        return self._sides_of(self.group()) if self.is_of_bodies else None

    def _sides_of(self, group: Group) -> PlaneFaces | None:
        """Of one convex body."""
        shape = group.shapes[0]
        if not isinstance(shape, Convex) or len(group) != 1:
            return None
        return PlaneFaces.of(shape, group.centre[0], matrices(group.orientation, self.dim)[0])

    def particles_of_bodies(
        self, group: Group, names: list[str], placed: Particles, owner: np.ndarray
    ) -> ParticleSet:
        """The particles of its bodies; `owner` (N,) is the body of each within the group."""
        n = len(owner)
        measure, wet = group.measures
        position = self.displaced(placed.position) if group.elastic else placed.position
        return ParticleSet(
            position=wrapped(self.scenario, position),
            velocity=self._velocities(group, position, owner),
            mass=self.rho0 * measure[owner] * placed.share,
            density=self.rho0 * (measure / wet)[owner],
            smoothing_length=np.full(n, self.scenario.eta * self.scenario.dp),
            motion=np.full(n, FIXED if group.fixed else BOUND, np.int32),
            **self._indices(names, n),
        )

    def _velocities(self, group: Group, position: np.ndarray, owner: np.ndarray) -> np.ndarray:
        """Velocities (N, dim), m/s, of the particles of its bodies."""
        arm = position - group.centre[owner]
        turning = np.cross(self.spin, np.pad(arm, ((0, 0), (0, 3 - self.dim))))[:, : self.dim]
        moved_by = position if group.elastic else group.centre[owner]
        return self.velocity_at(moved_by) + turning

    def elastic_bodies(
        self, group: Group, placed: Particles, owner: np.ndarray, first: int
    ) -> list[ElasticBody]:
        """See Body."""
        clamped = np.zeros(len(owner), bool)
        if self.table.clamped is not None:
            clamped = self.values_at("clamped", self.table.clamped, placed.position) > 0
        moved = self.displaced(placed.position)
        velocity = self._velocities(group, moved, owner)
        made = []
        for k in range(len(group)):
            own = np.flatnonzero(owner == k)
            volume = group.shapes[group.shape[k]].measure / len(own)
            spacing = volume ** (1 / self.dim)
            surface = self._surface(group, k, placed.position[own], placed.depth[own], spacing)
            made.append(
                ElasticBody(
                    self.name,
                    group.material,
                    first + own,
                    placed.position[own],
                    moved[own],
                    velocity[own],
                    spacing,
                    clamped[own],
                    surface,
                    self._cells(placed.position[own], surface, spacing),
                    group.breakable,
                )
            )
        return made

    @property
    def breaks(self) -> bool:
        """Whether its bodies may come apart."""
        return self.scenario.materials[self.table.material].fracture != NO_FRACTURE

    def _cells(self, rest: np.ndarray, surface: ElasticSurface, spacing: float) -> Cells:
        """Those of a 2-D body that breaks, whose particles are at `rest`."""
        if not self.breaks or self.dim == 3:
            return Cells()
        if (cells := cells_of(rest, surface.vertex, spacing)) is None:
            raise self.error(
                ": the particles of a body that breaks must resolve its outline: decrease dp"
            )
        return cells

    def _surface(
        self, group: Group, k: int, rest: np.ndarray, depth: np.ndarray, spacing: float
    ) -> ElasticSurface:
        """That of body k, whose particles are at `rest`, so deep in it, and `spacing` apart."""
        if self.dim == 3 and self.breaks:
            return balls_around(rest, depth, spacing)
        shape, turn = group.shapes[group.shape[k]], matrices(group.orientation, self.dim)[k]
        centre = group.centre[k]
        if self.dim == 3:
            particles = (rest - centre) @ turn
            (place, normal, area), nearest = shared_among(particles, shape.surface(spacing))
            none, share = np.zeros(len(area)), area / spacing**2
            crease = none.astype(bool)
            return ElasticSurface(
                centre + place @ turn.T, nearest, crease, normal @ turn.T, share, none
            )
        place, crease = shape.curve(self.spacing)
        vertex = centre + place @ turn.T
        nearest = cKDTree(rest).query(vertex)[1]
        none = np.zeros(len(place))
        return ElasticSurface(vertex, nearest, crease, np.zeros_like(place), none, none)

    @property
    def rotation(self) -> np.ndarray:
        """The matrix (dim, dim) by which it is turned."""
        return np.eye(self.dim)

    def wall(self, position: np.ndarray, particles: ParticleSet) -> tuple[np.ndarray, np.ndarray]:
        """See Body: along the given normal, by the gradient of `where`, or from the shape."""
        given = self.table.normal
        if given is not None:
            return self.plane_wall(position, self.rotation @ (given / np.linalg.norm(given)))
        if self.table.given("where") is not None:
            return self._carved_wall(position)
        return self.shape_wall(position, particles)

    def shape_wall(
        self, position: np.ndarray, particles: ParticleSet
    ) -> tuple[np.ndarray, np.ndarray]:
        """Normal and depth at each position as the shape has them."""
        return super().wall(position, particles)

    def edges(self, position: np.ndarray, particles: ParticleSet) -> Edges:
        """See Body: those of the shape, but of no wall that says itself where the fluid is."""
        if self.table.normal is not None or self.table.given("where") is not None:
            return super().edges(position, particles)
        return self.shape_edges(position, particles)

    def shape_edges(self, position: np.ndarray, particles: ParticleSet) -> Edges:
        """The faces beside edges as the shape has them."""
        return super().edges(position, particles)

    def plane_wall(self, position: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A plane wall: its surface is half a spacing beyond the foremost particles."""
        along = position @ normal
        surface = along.max() + 0.5 * self.spacing
        return np.tile(normal, (len(position), 1)), surface - along

    def _carved_wall(self, position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A surface where the body's `where` is zero: its gradient points into the wall."""
        step = 1e-3 * self.scenario.dp
        entry = self.table.given("where")

        def inside(x: np.ndarray) -> np.ndarray:
            return self.values_at("where", entry, x)

        gradient = np.stack(
            [
                (inside(position + shift) - inside(position - shift)) / (2 * step)
                for shift in step * np.eye(self.dim)
            ],
            axis=1,
        )
        slope = np.maximum(np.linalg.norm(gradient, axis=1), 1e-300)
        return -gradient / slope[:, None], inside(position) / slope
