"""What the result must not depend on: threads, the list's margin, the instruction set."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.solver.build import load_core

from ..simulations import ROCK, WATER, Simulations, colliding_grains, run_to

FIELDS = ("position", "velocity", "density", "deviatoric_stress", "pressure")


def collision(simulations, dim, time=1e-3, across=5, **options):
    """The state after a collision of a rock with a lump of water."""
    grains = colliding_grains(dim, across)
    material = np.arange(len(grains.position)) >= len(grains.position) // 2
    simulation = simulations(
        grains.position, grains.velocity, materials=(ROCK, WATER), columns={"material": material},
        alpha=1.0, gravity=[0.0] * (dim - 1) + [-9.8], **options,
    )  # fmt: skip
    return run_to(simulation, time)


def scale(field, values):
    """What an error of a field is measured against."""
    fixed = {"density": 1000.0, "position": 0.01}
    return fixed.get(field, np.abs(values).max())


def assert_close(state, expected, tolerance):
    """Every field within `tolerance` of its scale."""
    for field in FIELDS:
        error = np.abs(state[field] - expected[field]).max() / scale(field, expected[field])
        assert error < tolerance, f"{field}: {error:.2g}"


@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_threads_change_no_bit(core, simulate, dim, precision):
    across = {2: 20, 3: 8}[dim]
    states = []
    for threads in (1, 2, 4):
        core.set_threads(threads)
        simulation = collision(simulate, dim, 3e-4, across, precision=precision)
        states.append(
            simulation.state() | {"totals": simulation.totals(), "steps": simulation.steps}
        )
    for state in states[1:]:
        for name, values in states[0].items():
            np.testing.assert_equal(state[name], values, err_msg=name)


@pytest.mark.parametrize("skin", [0.0, 0.3, 1.0])
def test_margin_of_the_lists_changes_only_rounding(simulate, dim, skin):
    """Without a margin lists are built at every step, with a wide one hardly ever."""
    expected = collision(simulate, dim, skin=0.1)
    simulation = collision(simulate, dim, skin=skin)
    assert_close(simulation.state(), expected.state(), 1e-9)
    assert (simulation.rebuilds > expected.rebuilds) == (skin < 0.1)
    if skin == 0:
        assert simulation.rebuilds == simulation.steps + 1


def test_margin_serves_a_growing_smoothing_length(simulate, dim):
    expected = collision(simulate, dim, skin=0.0, h_mode="eq10")
    assert_close(collision(simulate, dim, skin=0.5, h_mode="eq10").state(), expected.state(), 1e-9)


@pytest.mark.isa
def test_instruction_set_changes_only_rounding(any_core, dim):
    expected = collision(Simulations(load_core("scalar")), dim).state()
    assert_close(collision(Simulations(any_core), dim).state(), expected, 1e-9)


def test_single_precision_is_close_to_double(simulate, dim):
    """Pair sums in float: 1e-7 a step, a few parts in 1e4 of the stress after a collision."""
    expected = collision(simulate, dim).state()
    assert_close(collision(simulate, dim, precision="mixed").state(), expected, 1e-3)


def test_single_precision_does_not_depend_on_the_place(simulate, dim):
    """A kilometre from the origin nothing is lost: pairs see differences of positions."""
    grains = colliding_grains(dim)
    states = [
        run_to(
            simulate(grains.position + place, grains.velocity, alpha=1.0, precision="mixed"), 1e-3
        ).state()
        for place in (0.0, 1024.0)
    ]
    states[1]["position"] -= 1024.0
    assert_close(states[1], states[0], 1e-3)


def test_order_of_the_particles_changes_only_rounding(simulate, dim):
    """The state comes back in the order of the ids, in whatever order particles went in."""
    grains = colliding_grains(dim)
    order = np.random.default_rng(1).permutation(len(grains.position))
    straight = run_to(simulate(grains.position, grains.velocity, alpha=1.0), 5e-4).state()
    shuffled = run_to(
        simulate(grains.position[order], grains.velocity[order], alpha=1.0, columns={"id": order}),
        5e-4,
    ).state()
    np.testing.assert_array_equal(shuffled["id"], np.arange(len(order)))
    assert_close(shuffled, straight, 1e-9)
