"""A simulation far from zero: what has places is moved, and no call that has is forgotten."""

from __future__ import annotations

import weakref

import numpy as np
import pytest

from doseki.solver.placed import Placed
from doseki.solver.protocol import CoreSimulation, Simulation, SimulationView

# Calls and properties whose arguments and results hold no place, or those of the core on purpose.
WITHOUT_PLACES = {
    "advance", "add_shapes", "bare_pair_rate", "begin_at", "bind_points", "bytes_per_particle",
    "checkpoint", "entries_per_particle", "failure", "force_terms", "forget_load_peak",
    "has_bodies", "interacting_pairs", "join", "loads", "neighbour_counts", "particle_arrays",
    "phase_seconds", "rates", "rebuilds", "restore", "restore_shared", "set_edges", "set_faces",
    "set_stresses", "set_walls", "shares", "skin", "start", "steps", "time", "time_phases",
    "timestep", "totals", "updates",
}  # fmt: skip


def test_every_call_of_a_simulation_is_known_to_have_places_or_none():
    calls = {
        name
        for kind in (SimulationView, Simulation, CoreSimulation)
        for name in vars(kind)
        if not name.startswith("_")
    }
    moved = {name for name in vars(Placed) if not name.startswith("_")}
    assert moved <= calls
    assert calls - moved == WITHOUT_PLACES


class Core:
    """It keeps what it is given to call, as the compiled one does."""

    def share_terrain(self, source):
        self.source = source

    make_room_in_terrain = share_terrain


@pytest.mark.parametrize("call", ["share_terrain", "make_room_in_terrain"])
def test_what_the_core_calls_does_not_keep_the_simulation(call):
    """Python sees no cycle through compiled code: such a simulation would never be freed."""
    core = Core()
    placed = Placed(core, np.array([6e5, 5e6, 100.0]))
    getattr(placed, call)(lambda part: np.array(part, float))
    alive = weakref.ref(placed)
    del placed
    assert alive() is None
    assert core.source is not None
