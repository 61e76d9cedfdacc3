"""A table [body.NAME], ready to be turned into particles or into bodies that move as a whole."""

from __future__ import annotations

from typing import Generic, TypeVar

import numpy as np

from ...errors import UserError
from ...record.particles import ParticleSet
from ...scenario.model import Scenario
from ...scenario.tables.body import BodyTable
from ...scenario.values.expressions import ExpressionError, evaluate_at, is_expression
from ...util.finding import Finding
from ..bodies import ElasticBody
from ..groups import Group, inside_bodies
from ..shapes import Edges, Particles, PlaneFaces, no_edges

T = TypeVar("T", bound=BodyTable)


class Body(Generic[T]):
    """One table [body.NAME] of a scenario.

    Shapes override what is theirs.  Every method raises UserError, which names the table, where
    its values allow no body.
    """

    def __init__(self, scenario: Scenario, name: str, table: T) -> None:
        self.scenario, self.name, self.table = scenario, name, table
        self.dim = scenario.dim
        self.kinematics = scenario.kinematics_of(name)

    @property
    def spacing(self) -> float:
        """Distance between its particles, m."""
        return self.table.given("dp") or self.scenario.dp

    @property
    def is_of_bodies(self) -> bool:
        """Whether its particles are those of rigid or deformable bodies, moving or fixed."""
        return self.kinematics.is_whole or self.table.is_solid

    @property
    def is_clamped(self) -> bool:
        """Whether points of it are held in place."""
        return self.table.given("clamped") is not None

    @property
    def spin(self) -> np.ndarray:
        """Angular velocity (3,) at the start, rad/s."""
        given = self.table.given("spin")
        if given is None:
            return np.zeros(3)
        return np.array([0.0, 0.0, given]) if np.ndim(given) == 0 else np.asarray(given, float)

    def error(self, text: str, key: str | None = None) -> UserError:
        """An error about the table, or about one of its keys; `text` follows the table's name."""
        keys = ("body", self.name) if key is None else ("body", self.name, key)
        return self.scenario.where.error(keys, f"body.{self.name}{text}")

    def values_at(self, key: str, entry: float | str, position: np.ndarray) -> np.ndarray:
        """A number, or an expression of the position, at each of the positions (N, dim)."""
        if not is_expression(entry):
            return np.full(len(position), float(entry))
        try:
            return evaluate_at(str(entry), self.scenario.constants, position)
        except ExpressionError as error:
            raise self.error(f".{key}: {error}", key) from None

    def velocity_at(self, position: np.ndarray) -> np.ndarray:
        """Initial velocities (N, dim), m/s: numbers, or expressions of the position."""
        return self._vectors_at("velocity", position)

    def displaced(self, rest: np.ndarray) -> np.ndarray:
        """Where points of an elastic body start (N, dim), m, that are at `rest` without stress."""
        return rest + self._vectors_at("displacement", rest)

    def _vectors_at(self, key: str, position: np.ndarray) -> np.ndarray:
        """A vector of numbers or expressions at each of the positions; zero where none is given."""
        vectors = np.zeros_like(position)
        for axis, entry in enumerate(self.table.given(key) or []):
            vectors[:, axis] = self.values_at(key, entry, position)
        return vectors

    def count(self) -> float:
        """How many particles it will have, or nearly; the size of a box may exceed any integer."""
        raise NotImplementedError

    def particles(self, names: list[str]) -> ParticleSet:
        """Its particles, where they are no parts of bodies; `names` are those of all bodies."""
        raise NotImplementedError

    def group(self) -> Group:
        """The bodies that it is, where `is_of_bodies`."""
        raise NotImplementedError

    def particles_of_bodies(
        self, group: Group, names: list[str], placed: Particles, owner: np.ndarray
    ) -> ParticleSet:
        """The particles of its bodies, where `is_of_bodies`.

        They are those `placed`, in `displaced` positions if deformable; `owner` (N,) is the body of
        each within the group.
        """
        raise NotImplementedError

    def elastic_bodies(
        self, group: Group, placed: Particles, owner: np.ndarray, first: int
    ) -> list[ElasticBody]:
        """Its deformable bodies, whose particles are numbered from `first`."""
        raise NotImplementedError

    def contact_shape(self) -> Group | None:
        """The one body that those which touch it meet, where it is fixed and its shape is whole."""
        return None

    def faces(self) -> np.ndarray | None:
        """Corners (n, dim, dim), m, of the faces of a whole fixed body before it moves.

        They are triangles, in 2-D segments, seen anticlockwise from outside.  None where it has no
        faces, or particles lie along them as on a lattice.
        """
        return None

    def plane_faces(self) -> PlaneFaces | None:
        """The sides of a fixed body before it moves, where fluid may meet each of them."""
        return None

    def encloses(self, position: np.ndarray) -> np.ndarray:
        """Mask (N,) of the positions (N, dim), m, that lie in it where it is fixed.

        Nowhere in what is no whole shape: a file's particles, points, a box filled up to a number.
        """
        group = self.group() if self.is_of_bodies else self.contact_shape()
        if group is None:
            return np.zeros(len(position), bool)
        return inside_bodies(self.scenario, [group], position)

    def findings(self) -> list[Finding]:
        """What is doubtful about it."""
        return []

    def sides(self, thickness: float) -> list[Group]:
        """Walls that hold it while it settles."""
        return []

    def wall(self, position: np.ndarray, particles: ParticleSet) -> tuple[np.ndarray, np.ndarray]:
        """Normals (N, dim) into the fluid and depths (N,) below the surface, m, of a fixed body.

        `position` are its particles, among all the `particles` of the scene.
        """
        raise self.error(": a wall of points needs its normal = [...] into the fluid")

    def edges(self, position: np.ndarray, particles: ParticleSet) -> Edges:
        """The faces beside the edges of a fixed body, for its particles at `position` (N, dim)."""
        return no_edges(len(position), self.dim)
