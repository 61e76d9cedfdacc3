"""One broken particle breaks the rates of all its neighbours: it alone must be named."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, empty_simulation, load_core

BLOCK = """\
dim = {dim}
dp = 0.01
time_max = 1
time_out = 1
{scheme}
{grown}

[body.block]
shape = "box"
material = "water"
min = {low}
max = {high}
"""
SCHEMES = {
    "ueta2022": 'scheme = "ueta2022"\nxi = 0.05',
    "resolved": 'scheme = "resolved"\nspeed_max = 1',
}
MODES = [
    ("ueta2022", 'h_mode = "eq10"'),
    ("ueta2022", 'precision = "mixed"'),
    ("ueta2022", ""),
    ("resolved", ""),
    ("resolved", 'precision = "mixed"'),
]
BROKEN = {
    "velocity not a number": ("velocity", np.nan, "not_finite"),
    "velocity infinite": ("velocity", np.inf, "not_finite"),
    "density not a number": ("density", np.nan, "not_finite"),
    "density zero": ("density", 0.0, "density"),
    "density negative": ("density", -1000.0, "density"),
    "density absurd": ("density", 1e5, "density"),
}
IDS = [0, 35, 36, 77]  # at a corner, inside, its neighbour in the same cluster, at a side


@pytest.fixture(params=MODES, ids=["grown", "mixed", "double", "resolved", "resolved, mixed"])
def block(request, tmp_path, dim):
    """A resting block of water, some 100 particles, and its scenario and bodies."""
    scheme, more = request.param
    corners = {"low": [0.0] * dim, "high": [0.1, 0.1, 0.05][:dim]}
    text = BLOCK.format(dim=dim, scheme=SCHEMES[scheme], grown=more, **corners)
    (tmp_path / "block.toml").write_text(text)
    scenario = load_scenario(str(tmp_path / "block.toml"))
    simulation, names = build_simulation(scenario)
    simulation.advance(limit=1.0, pause=1.0, max_steps=3)
    return scenario, simulation, names


@pytest.fixture(params=[2, 3])
def dim(request):
    return request.param


@pytest.mark.parametrize("broken", BROKEN)
@pytest.mark.parametrize("number", IDS)
def test_the_broken_particle_is_named_not_its_neighbour(block, broken, number):
    scenario, simulation, names = block
    field, value, kind = BROKEN[broken]
    arrays = simulation.checkpoint()
    (row,) = np.flatnonzero(arrays["id"] == number)
    arrays[field][row] = value
    copy = empty_simulation(scenario, names)
    copy.restore(arrays)
    with pytest.raises(load_core().PhysicsFailure, match=rf"particle {number} \(water\)"):
        copy.advance(limit=1.0, pause=1.0, max_steps=3)
    found, particle, position = copy.failure
    assert particle == number
    last = simulation.state()["position"][number]
    assert len(position) == scenario.dim
    if np.isfinite(position).all():
        np.testing.assert_allclose(position, last, atol=scenario.support)
    assert found in (kind, "outside", "speed")
