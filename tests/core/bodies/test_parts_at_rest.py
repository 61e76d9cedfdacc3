"""Parts of broken bodies that have come to rest within themselves are rigid, and may leave."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.solver.restoring import check_state
from doseki.solver.rigid_bodies import grain_table

from . import test_breakable
from .test_breakable import DENSITY, MEETS, deformable, energy, pair, run, sums

build = test_breakable.build
FINE = 0.005  # m, so that halves of discs have no corner that falls off
DAMPED = "damping = 0.2\nkinematics"


def struck(dim: int, share: float, turn: float = 0.3, spin: float = 10.0) -> str:
    """Tables of two balls that meet, in which vibrations die down soon."""
    return pair(dim, "breakable", share * MEETS, turn, spin).replace("kinematics", DAMPED)


def cut_in_two(simulation) -> None:
    """All bodies that deform, between two columns of points in their middles."""
    state, core = simulation.state(), getattr(simulation, "_core", simulation)
    bound = state["grain"] >= 0
    position, grain = state["position"][bound], state["grain"][bound]
    side = np.zeros(len(position), np.int32)
    for number in np.unique(grain):
        own = grain == number
        side[own] = position[own, 0] > position[own, 0].mean()
    core.cut_bodies(side)


def dust(simulation) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of grains that are the square of one point in 2-D.

    Moment of inertia beyond that of its particle, kg m2/m, spin, rad/s, and which have left.
    """
    grains = simulation.grains()
    is_dust = (grains["parent"] >= 0) & (grains["mass"] < 1.01 * FINE**2 * DENSITY)
    inertia = grains["mass"] ** 2 / (6 * DENSITY)
    return inertia[is_dust], grains["spin"][is_dust, 2], grains["removed"][is_dust]


def spinning_energy(simulation) -> float:
    """Which went with grains that have left, and is not that of their particles, J/m."""
    inertia, spin, left = dust(simulation)
    return float((0.5 * inertia * spin**2)[left].sum())


@pytest.mark.parametrize(("dim", "share"), [(2, 7.0), (3, 6.0)])
@pytest.mark.parametrize("turn", [0.3, 1.1])
def test_what_has_broken_is_rigid_in_the_end_and_nothing_is_lost(build, dim, share, turn):
    """Mass, momentum and the account of energy, through parts, dust and rest."""
    simulation = build(struck(dim, share, turn), dim)
    mass, momentum, _ = sums(simulation)
    start, most, work = energy(simulation), 0, []
    for time in (0.0005, 0.001, 0.0015, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064):
        run(simulation, time)
        most = max(most, deformable(simulation))
        now, totals = sums(simulation), simulation.totals()
        assert now[0] == pytest.approx(mass, rel=1e-13)
        np.testing.assert_allclose(now[1], momentum, rtol=0, atol=1e-10 * mass * MEETS)
        assert energy(simulation) - totals["contact_work"] == pytest.approx(start, rel=1e-3)
        work.append(totals["contact_work"])
    assert min(totals["parts"], totals["dust_grains"]) > 0
    assert most >= 2
    # A lobe that few bonds hold may flap for long, in both balls, which mirror each other: one part
    # in five is such a one, two or three of ten by chance.
    assert deformable(simulation) <= 0.4 * (totals["parts"] + 2)
    assert all(work[-1] <= earlier + 1e-3 * start for earlier in work[3:])  # rest makes none


@pytest.mark.parametrize("turn", [0.3, 1.1, 2.0])
@pytest.mark.parametrize("look", [1e-4, 5e-4])
def test_the_account_of_balls_that_break_closes_however_seldom_one_looks(build, turn, look):
    """Points with few bonds ask for shorter steps than whole bodies do."""
    simulation = build(struck(3, 8.0, turn), 3)
    start = energy(simulation)
    for time in np.arange(look, 0.0025, look):
        run(simulation, time)
    assert simulation.totals()["dust_grains"] > 50
    made = energy(simulation) - simulation.totals()["contact_work"] - start
    assert abs(made) < 5e-3 * start


@pytest.mark.parametrize(("share", "turn"), [(6.0, 0.3), (6.0, 1.1), (7.0, 1.1)])
def test_contacts_make_no_energy_when_parts_come_off(build, share, turn):
    """What touches goes on to touch, whatever numbers its points have afterwards."""
    simulation = build(struck(3, share, turn), 3)
    core = getattr(simulation, "_core", simulation)
    start, before = energy(simulation), 0.0
    for time in np.arange(1e-5, 0.0025, 1e-5):
        for left in np.linspace(8.75e-6, 0, 8):  # the error of a step falls with its square
            run(simulation, time - left)
        stored = core.body_energy()["contacts"]
        given = simulation.totals()["contact_work"] + stored
        assert given < before + 1e-3 * start
        before = given
    assert simulation.totals()["dust_grains"] > 20


def test_a_part_keeps_its_row_and_its_momenta_when_it_becomes_rigid(build):
    """Halves, and a point that falls off each: to rounding."""
    simulation = build(struck(2, 1.2, 0.0, 0.0), dp=FINE)
    run(simulation, 0.0006)
    assert deformable(simulation) == 2
    cut_in_two(simulation)
    before, table = sums(simulation), grain_table(simulation)
    assert deformable(simulation) == 4
    count = simulation.totals()["dust_grains"]
    assert len(table["mass"]) == 4 + count
    run(simulation, 0.02)
    assert deformable(simulation) == 0
    after, rows = sums(simulation), grain_table(simulation)
    scale = 1e-12 * before[0] * MEETS
    assert after[0] == pytest.approx(before[0], rel=1e-13)
    np.testing.assert_allclose(after[1], before[1], rtol=0, atol=scale)
    inertia, spin, _ = dust(simulation)
    assert len(spin) == count
    spinning = (inertia * spin).sum()
    np.testing.assert_allclose(after[2][2] + spinning, before[2][2], rtol=0, atol=scale)
    for key in ("parent", "born"):
        assert np.array_equal(rows[key], table[key]), key
    np.testing.assert_allclose(rows["mass"], table["mass"], rtol=1e-13)
    assert simulation.totals()["parts"] == 2
    held = simulation.totals()
    run(simulation, 0.03)
    for key in ("kinetic_energy", "elastic_energy", "damping_work"):
        assert simulation.totals()[key] == pytest.approx(held[key], rel=1e-9, abs=1e-12), key


def test_a_rigid_part_touches_by_its_outline(build):
    """Halves of discs fall on a floor: points come as near to it as they are below surfaces."""
    floor = """
[body.floor]
shape = "box"
material = "chalk"
fixed = true
min = [-1, -0.15]
max = [1, -0.1]
"""
    simulation = build(struck(2, 1.2, 0.0, 0.0) + floor, gravity=[0, -9.81])
    run(simulation, 0.0006)
    cut_in_two(simulation)
    lowest, rests = np.inf, False
    for time in np.arange(0.01, 0.2, 0.004):
        run(simulation, time)
        state = simulation.state()
        lowest = min(lowest, state["position"][state["grain"] >= 0, 1].min())
        rests |= deformable(simulation) == 0 and lowest < -0.09
    depth = 0.005  # m, half a spacing
    assert rests
    assert lowest == pytest.approx(-0.1 + depth, abs=0.2 * depth)


@pytest.mark.parametrize(("dim", "share"), [(2, 7.0), (3, 7.0)])
def test_a_restored_run_has_the_same_rigid_parts(build, dim, share):
    """Saved while some parts are rigid and others not."""
    simulation = build(struck(dim, share), dim)
    run(simulation, 0.002)
    while not deformable(simulation) < simulation.totals()["parts"] + 2:
        run(simulation, simulation.time + 2e-4)
        assert simulation.time < 0.016
    saved, end = simulation.checkpoint(), simulation.time + 0.002
    other = build.again()
    check_state(other, saved, 1, 2)
    assert other.restore(saved)
    for one in (simulation, other):
        one.advance(limit=end, pause=end, max_steps=100_000)
    for key in ("position", "velocity", "grain"):
        assert np.array_equal(simulation.state()[key], other.state()[key]), key
    assert simulation.totals() == other.totals()


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("rests", [False, True])
def test_parts_leave_through_an_outflow(build, dim, rests):
    """While they deform, and when they are rigid: with their mass and their energy."""
    reach = "[1, 1]" if dim == 2 else "[1, 1, 1]"
    edge = 0.12 if rests else 0.053  # m
    low = f"[{edge}, -1]" if dim == 2 else f"[{edge}, -1, -1]"
    region = f"\n[outflow.right]\nmin = {low}\nmax = {reach}\n"
    found = {}
    for outflow in ("", region):
        simulation = build(struck(dim, 1.2, 0.0, 0.0) + outflow, dim, dp=FINE if dim == 2 else None)
        mass = sums(simulation)[0]
        run(simulation, 0.0006)
        assert deformable(simulation) == 2
        cut_in_two(simulation)
        run(simulation, 0.025)
        totals = simulation.totals()
        left = totals["energy_left"] + spinning_energy(simulation)
        found[outflow] = energy(simulation) - totals["contact_work"] + left
    totals, rows = simulation.totals(), grain_table(simulation)
    gone = rows["removed"]
    assert gone.any()
    assert len(gone) == 4 + totals["dust_grains"]
    assert totals["mass"] + totals["mass_left"] == pytest.approx(mass, rel=1e-12)
    assert totals["mass"] == pytest.approx(rows["mass"][~gone].sum(), rel=1e-12)
    if dim == 2:
        # What leaves while it vibrates takes the error of its steps along.
        assert found[region] == pytest.approx(found[""], rel=1e-9 if rests else 1e-6)


@pytest.mark.parametrize(("share", "turn"), [(6.5, 1.1), (6.0, 1.1), (7.0, 0.3), (8.0, 1.1)])
def test_particles_follow_bodies_that_change_often_within_a_step(build, share, turn):
    """Rigid discs are struck, break into parts that become rigid, and shed dust: all at once."""
    simulation = build(struck(2, share, turn))
    mass, momentum, _ = sums(simulation)
    simulation.advance(limit=0.002, pause=0.002, max_steps=1)
    assert simulation.time == 0.002
    totals = simulation.totals()
    assert min(totals["parts"], totals["dust_grains"]) > 0
    np.testing.assert_allclose(sums(simulation)[1], momentum, rtol=0, atol=1e-12 * mass * MEETS)
    assert (simulation.state()["grain"] >= 0).all()
