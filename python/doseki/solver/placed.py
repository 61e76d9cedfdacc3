"""A simulation far from the origin of its coordinates, whose core works near zero."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..scenario.model import Scenario
from .protocol import Arrays, Columns, CoreSimulation, Fragments, Grains, Table

STEP = 1024.0  # m: a power of two, so that what is subtracted is added again without rounding


def origin_of(scenario: Scenario) -> np.ndarray:
    """The place (dim,), m, in the scenario's coordinates that is zero in the core."""
    if scenario.bed is None:
        return np.zeros(scenario.dim)
    low, high = scenario.bed.corners
    return np.asarray(STEP * np.rint(0.5 * (low + high) / STEP))


class Placed:
    """A core simulation that is called in the coordinates of a map.

    Checkpoints keep the coordinates of the core.
    """

    def __init__(self, core: CoreSimulation, origin: np.ndarray) -> None:
        self._core, self._origin = core, origin

    def __getattr__(self, name: str) -> Any:
        return getattr(self._core, name)

    def __len__(self) -> int:
        return len(self._core)

    def _near(self, position: Any) -> np.ndarray:
        """Positions of the map as the core has them."""
        return np.ascontiguousarray(np.asarray(position, float) - self._origin)

    def _on_map(self, table: Any, key: str) -> Any:
        """A table of results with positions of the map under a key."""
        if len(table[key]):
            table[key] = table[key] + self._origin
        return table

    def add_particles(self, **columns: np.ndarray) -> None:
        """See CoreSimulation."""
        self._core.add_particles(**columns | {"position": self._near(columns["position"])})

    def add_rigid_bodies(self, bodies: Arrays) -> None:
        """See CoreSimulation."""
        self._core.add_rigid_bodies({**bodies, "centre": self._near(bodies["centre"])})

    def add_elastic_body(self, body: Table) -> None:
        """See CoreSimulation."""
        places = {key: self._near(body[key]) for key in ("rest", "position", "vertex")}
        self._core.add_elastic_body({**body, **places})

    def add_inflow(self, inflow: Table) -> None:
        """See CoreSimulation."""
        self._core.add_inflow({**inflow, "layer": self._near(inflow["layer"]).tolist()})

    def add_outflow(self, low: Sequence[float], high: Sequence[float]) -> None:
        """See CoreSimulation."""
        self._core.add_outflow(self._near(low).tolist(), self._near(high).tolist())

    def add_plane(self, point: Sequence[float], normal: Sequence[float]) -> None:
        """See CoreSimulation."""
        self._core.add_plane(self._near(point).tolist(), list(normal))

    def move_body(self, motion: Table) -> None:
        """See CoreSimulation."""
        self._core.move_body({**motion, "pivot": self._near(motion["pivot"]).tolist()})

    def add_load_meter(self, meter: Table) -> None:
        """See CoreSimulation."""
        places = {k: self._near(meter[k]).tolist() for k in ("about", "origin") if k in meter}
        self._core.add_load_meter({**meter, **places})

    def set_terrain(self, field: Table, wall: Table) -> None:
        """See CoreSimulation."""
        corner = np.asarray(field["origin"], float) - self._origin[:-1]
        heights = np.ascontiguousarray(np.asarray(field["heights"]) - self._origin[-1])
        self._core.set_terrain({**field, "origin": corner.tolist(), "heights": heights}, wall)

    def share_terrain(self, source: Callable[[list[float]], np.ndarray]) -> None:
        """See CoreSimulation."""
        height = self._origin[-1]  # the core keeps `near`, which must not keep the core

        def near(part: list[float]) -> np.ndarray:
            found = np.array(source(part))
            found[: len(found) // 2] -= height
            return found

        self._core.share_terrain(near)

    def make_room_in_terrain(self, remainder: Callable[[list[float]], np.ndarray]) -> None:
        """See CoreSimulation."""
        to_map = np.concatenate([self._origin, np.zeros_like(self._origin)])
        from_map = np.concatenate([np.zeros(1), self._origin])

        def near(cells: list[float]) -> np.ndarray:
            rows = np.reshape(cells, (-1, len(to_map))) + to_map
            return np.asarray(
                remainder(rows.ravel().tolist()) - np.resize(from_map, len(rows) * len(from_map))
            )

        self._core.make_room_in_terrain(near)

    def state(self) -> Columns:
        """See SimulationView."""
        found: Columns = self._on_map(self._core.state(), "position")
        return found

    def sample(self, low: Sequence[float], high: Sequence[float]) -> Columns:
        """See Simulation."""
        box = self._near(low).tolist(), self._near(high).tolist()
        found: Columns = self._on_map(self._core.sample(*box), "position")
        return found

    def grains(self) -> Grains:
        """See Simulation."""
        found: Grains = self._on_map(self._core.grains(), "centre")
        return found

    def fragments(self) -> Fragments:
        """See Simulation."""
        found: Fragments = self._on_map(self._core.fragments(), "centre")
        return found
