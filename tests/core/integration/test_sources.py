"""Inflow, outflow and fixed particles: who moves, who counts."""

from __future__ import annotations

import numpy as np
import pytest

from ..simulations import FIXED, FOREVER, ROCK, WATER, lattice, run_to

DP = 0.0078125  # sums of masses of these particles are exact
MASS = 0.0625
DRIVEN = 2
SPEED, START, STOP = 0.9, 0.013, 0.113


def inflow(dim, **changes):
    """Three rows (and in 3-D two across) that flow along x from the origin."""
    rows = [[0.0] * (dim - 1) + [(k + 0.5) * DP] for k in range(3)]
    if dim == 3:
        rows = [[0.0, y * DP, row[2]] for row in rows for y in (0, 1)]
    return {
        "layer": rows, "direction": [1.0] + [0.0] * (dim - 1), "speed": SPEED, "spacing": DP,
        "mass": MASS, "density": 1000.0, "smoothing_length": 1.2 * DP, "start": START, "stop": STOP,
        "buffer_layers": 4, "jitter": 0.0, "material": 0, "body": 1,
    } | changes  # fmt: skip


@pytest.fixture
def channel(simulate, dim):
    """A run with one inflow and an outflow 50 mm downstream; one particle stands far away."""
    low, high = [0.05] + [-1.0] * (dim - 1), [0.5] + [1.0] * (dim - 1)
    return simulate(
        np.full((1, dim), 5.0), 0.0, materials=(WATER,), alpha=1.0, tension="clamp_fluid", dp=DP,
        columns={"mass": MASS}, inflows=(inflow(dim),), outflows=((low, high),),
    )  # fmt: skip


def test_ledger_closes_at_every_step(channel, dim):
    """What entered is what was asked for, to half a layer; initial + entered = inside + left."""
    layer = MASS * 3 * (dim - 1)
    rate = layer * SPEED / DP
    while channel.time < 0.2:
        channel.advance(limit=0.2, pause=channel.time + 1e-3, max_steps=FOREVER)
        totals = channel.totals()
        asked = rate * np.clip(channel.time - START, 0, STOP - START)
        assert totals["mass_asked"] == pytest.approx(asked, rel=1e-12)
        assert abs(totals["mass_entered"] - asked) <= 0.5 * layer * (1 + 1e-9)
        assert (
            totals["mass_initial"] + totals["mass_entered"] == totals["mass"] + totals["mass_left"]
        )
    assert totals["mass_left"] > 3 * layer
    assert totals["mass_initial"] == MASS


def test_nothing_enters_before_the_start(channel):
    run_to(channel, 0.99 * START)
    assert len(channel) == 1
    assert channel.totals()["mass_entered"] == 0


def test_buffer_moves_as_prescribed_and_goes_at_the_end(channel, dim):
    run_to(channel, 0.06)
    state = channel.state()
    driven = state["motion"] == DRIVEN
    assert driven.sum() == 4 * 3 * (dim - 1)
    assert (state["position"][driven, 0] < 1e-12).all()
    np.testing.assert_array_equal(
        state["velocity"][driven], [[SPEED] + [0.0] * (dim - 1)] * driven.sum()
    )
    offsets = np.sort(np.unique(np.round(state["position"][driven, 0] / DP, 6)))
    np.testing.assert_allclose(np.diff(offsets), 1, atol=1e-5)
    run_to(channel, STOP)
    assert (channel.state()["motion"] != DRIVEN).all()


def test_driven_particles_do_not_count_as_inside(channel):
    run_to(channel, 0.06)
    state = channel.state()
    assert channel.totals()["mass"] == MASS * np.sum(state["motion"] != DRIVEN)
    assert channel.totals()["count"] == [np.sum(state["motion"] != DRIVEN)]


def test_ids_stay_unique(channel):
    seen = {}
    while channel.time < 0.15:
        channel.advance(limit=0.15, pause=channel.time + 5e-3, max_steps=FOREVER)
        ids = channel.state()["id"].tolist()
        assert len(ids) == len(set(ids))
        seen |= dict.fromkeys(ids)
    assert 0 in seen


def test_two_inflows_share_the_ledger(simulate, dim):
    """Each keeps its own clock; the second starts and stops later."""
    first, second = inflow(dim), inflow(dim, body=2, start=0.03, stop=0.2, speed=0.5)
    second["layer"] = [[x, *rest[:-1], rest[-1] + 0.3] for x, *rest in second["layer"]]
    simulation = simulate(
        np.full((1, dim), 5.0), 0.0, materials=(WATER,), dp=DP, columns={"mass": MASS},
        inflows=(first, second),
    )  # fmt: skip
    run_to(simulation, 0.25)
    per_length = MASS * 3 * (dim - 1) / DP
    asked = per_length * (SPEED * (STOP - START) + 0.5 * 0.17)
    assert simulation.totals()["mass_asked"] == pytest.approx(asked, rel=1e-12)
    assert abs(simulation.totals()["mass_entered"] - asked) <= per_length * DP


def test_outflow_removes_and_counts(simulate, dim):
    """Three free particles fly into the box one after the other; a fixed one in it stays."""
    position = np.zeros((4, dim))
    position[:, 0] = 0.0, -0.1, -0.2, 0.35
    velocity = np.zeros((4, dim))
    velocity[:3, 0] = 1.0
    box = ([0.3] + [-1.0] * (dim - 1), [0.4] + [1.0] * (dim - 1))
    simulation = simulate(
        position,
        velocity,
        columns={"motion": [0, 0, 0, FIXED], "mass": [1.0, 2.0, 4.0, 8.0]},
        outflows=(box,),
        skin=0.0,
    )
    counts, left = [], []
    for time in (0.29, 0.31, 0.41):
        run_to(simulation, time)
        counts.append(len(simulation))
        left.append(simulation.totals()["mass_left"])
    assert counts == [4, 3, 2]
    assert left == [0, 1, 3]
    assert simulation.totals()["mass"] == 4
    assert simulation.state()["id"].tolist() == [2, 3]


def hammered_bed(simulate, dim):
    """A block of rock thrown onto a fixed bed."""
    counts = (8,) * (dim - 1)
    bed, block = lattice((*counts, 3)), lattice((*counts, 3))
    block[:, -1] += 0.035
    motion = np.repeat([FIXED, 0], [len(bed), len(block)])
    velocity = np.zeros((len(motion), dim))
    velocity[len(bed) :, -1] = -3.0
    position = np.concatenate([bed, block])
    return simulate(position, velocity, alpha=1.0, columns={"motion": motion}), motion == FIXED


def test_fixed_particles_never_move(simulate, dim):
    simulation, fixed = hammered_bed(simulate, dim)
    before = simulation.state()
    after = run_to(simulation, 4e-3).state()
    for field in ("position", "velocity", "deviatoric_stress"):
        np.testing.assert_array_equal(after[field][fixed], before[field][fixed])
    assert np.abs(after["velocity"][~fixed] - before["velocity"][~fixed]).max() > 1


def test_fixed_particles_are_compressed(simulate, dim):
    """Their density follows what comes near, and with it their pressure."""
    simulation, fixed = hammered_bed(simulate, dim)
    run_to(simulation, 1e-3)
    state = simulation.state()
    assert state["density"][fixed].max() > ROCK["rho0"] * 1.001
    assert state["pressure"][fixed].max() > 0
    assert state["pressure"][fixed].min() == 0


def test_fixed_particles_do_not_count_in_the_totals(simulate, dim):
    simulation, fixed = hammered_bed(simulate, dim)
    state, totals = simulation.state(), simulation.totals()
    assert totals["mass"] == pytest.approx(state["mass"][~fixed].sum(), rel=1e-14)
    assert totals["count"] == [np.sum(~fixed)]
    assert totals["mass_initial"] == pytest.approx(totals["mass"], rel=1e-14)
