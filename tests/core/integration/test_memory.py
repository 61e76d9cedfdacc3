"""What a particle of the resolved scheme takes in memory."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import FILM, advance

WALL_FIELDS = (
    "normal", "wall_bend", "wall_depth", "edge_normals", "edge_depths", "wall_cut", "wall_force",
    "wall_moment", "wall_spin", "wall_pressure", "face", "face_area", "face_wetted", "film_change",
    "film_cover", "film_density", "film_traction", "film_aside", "body_kind", "point",
)  # fmt: skip
FLOW_FIELDS = (
    "pressure_gradient", "velocity_gradient", "inverse_moment", "shift", "surface",
    "surface_around", "mixing_length", "mean_pressure", "damping_pressure", "parted", "in_film",
    "least_pressure",
)  # fmt: skip
COMMON_FIELDS = (
    "position", "velocity", "acceleration", "density", "density_rate", "mass", "smoothing_length",
)  # fmt: skip
TAG = 16
# Bytes of the records of a pass in double, half of them in single; of the place at the last
# build and its cell, of an entry of a list.
MOTION_RECORD, FLOW_RECORD, WALL_RECORD = {2: 48, 3: 64}, {2: 144, 3: 224}, {2: 200, 3: 320}
PLACE, ENTRY = {2: 24, 3: 32}, 2
SPARE = 0.08  # of all: summaries, cells, blocks of lists


@pytest.mark.parametrize(("precision", "part"), [("double", 1.0), ("mixed", 0.5)])
@pytest.mark.parametrize("dim", [2, 3])
def test_walls_and_flow_take_only_what_is_theirs(core, flows, dim, precision, part):
    """On one thread: each has blocks of lists of its own."""
    run = advance(flows(FILM.format(dim=dim), f"precision={precision}"), 20)
    saved, walls = run.checkpoint(), run.state()["motion"] != 0
    n, n_walls = len(walls), int(walls.sum())

    def row(names):
        return sum(np.asarray(saved[name]).nbytes / n for name in names)

    everyone = row(COMMON_FIELDS) + TAG + part * MOTION_RECORD[dim] + PLACE[dim]
    expected = n * (everyone + ENTRY * run.entries_per_particle)
    expected += (n - n_walls) * (row(FLOW_FIELDS) + part * FLOW_RECORD[dim])
    expected += n_walls * (row(WALL_FIELDS) + part * WALL_RECORD[dim])
    assert expected <= n * run.bytes_per_particle < (1 + SPARE) * expected
    # What it would be if all had everything is far outside.
    both = n_walls * row(FLOW_FIELDS) + (n - n_walls) * row(WALL_FIELDS)
    assert both > 2 * SPARE * expected


def test_what_is_not_of_a_particle_reads_as_zero(flows):
    run = advance(flows(FILM.format(dim=2)), 20)
    state, saved = run.state(), run.checkpoint()
    walls = state["motion"] != 0
    assert (state["force"][~walls] == 0).all()
    assert (state["velocity_gradient"][walls] == 0).all()
    assert np.abs(state["force"][walls]).max() > 0
    assert np.abs(state["velocity_gradient"][~walls]).max() > 0
    assert len(np.asarray(saved["shift"]).reshape(-1, 2)) == len(walls)
