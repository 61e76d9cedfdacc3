"""Clamped bodies stand: maps count them only once they are torn off."""

from __future__ import annotations

import numpy as np

from doseki.measure.maps.standing import clamped_bodies, flowing, standing
from doseki.record.particles import BOUND, FREE

NAMES = ["water", "dam", "gate", "boulder"]
TABLES = {"dam": {"clamped": "= z"}, "boulder": {}, "gate": {"clamped": "= 1 - x"}}


def state_of(*rows):
    """Rows of (body, part, motion, speed)."""
    body, grain, motion, speed = np.array(rows).T
    velocity = np.zeros((len(rows), 3))
    velocity[:, 0] = speed
    kinds = {"body": body, "grain": grain, "motion": motion}
    fields = {"velocity": velocity, "mass": np.ones(len(rows))}
    return {key: value.astype(int) for key, value in kinds.items()} | fields


def test_parts_with_a_clamped_point_stand():
    """The foot of a dam does, what was torn off it does not; nor do a boulder and still water."""
    clamped = clamped_bodies(NAMES, TABLES)
    assert clamped.tolist() == [1, 2]
    state = state_of(
        (0, -1, FREE, 0.0),
        (1, 2, BOUND, 0.0),  # clamped
        (1, 2, BOUND, 1e-9),
        (1, 7, BOUND, 1.0),  # a part that has come off
        (1, 7, BOUND, 2.0),
        (2, -1, BOUND, 0.0),
        (2, -1, BOUND, 0.1),
        (3, 2, BOUND, 0.0),  # another body's part 2, at rest
    )
    stands = [False, True, True, False, False, True, True, False]
    assert standing(state, clamped).tolist() == stands
    assert len(flowing(state, clamped)["body"]) == 4


def test_without_clamped_bodies_nothing_stands():
    state = state_of((0, -1, FREE, 0.0), (3, 0, BOUND, 0.0))
    assert not standing(state, clamped_bodies(NAMES, {})).any()
    assert len(flowing(state, clamped_bodies(NAMES, {}))["motion"]) == 2


def test_a_body_that_spins_is_as_fast_as_its_centre():
    state = state_of((0, -1, FREE, 4.0), (3, 0, BOUND, 0.0), (3, 0, BOUND, 6.0), (3, 1, BOUND, 1.0))
    state["mass"][2] = 2.0
    for clamped in (clamped_bodies(NAMES, {}), clamped_bodies(NAMES, TABLES)):
        shown = flowing(state, clamped)
        assert shown["velocity"][:, 0].tolist() == [4.0, 4.0, 4.0, 1.0]
    assert state["velocity"][:, 0].tolist() == [4.0, 0.0, 6.0, 1.0]
