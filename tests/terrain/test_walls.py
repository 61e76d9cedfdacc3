"""Wall particles of a terrain: where there is flow, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.solver.build import empty_simulation, filled_simulation
from doseki.solver.restoring import check_state

from .scenes import fluid, grid, profile, simulation_of, step, text

SLIDE = """
[body.slide]
shape = "release"
material = "water"
between = [0.5, 1.5]
thickness = 0.3
"""
SLAB = """
[body.slide]
shape = "release"
material = "water"
polygon = [[1, 1.5], [2, 1.5], [2, 2.5], [1, 2.5]]
thickness = 0.3
"""


def slope(x):
    return np.maximum(2.0 - 0.6 * x, 0.0) + 0.03 * np.sin(5 * x)


@pytest.fixture
def slide(tmp_path):
    """A slide in 2-D, ready to be run."""
    profile(tmp_path / "terrain.csv", slope, high=12.0)
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.05, speed=6.0, more=SLIDE))
    return path


def test_walls_have_the_volume_of_the_ground_below_the_surface(tmp_path):
    grid(tmp_path / "terrain.asc", lambda x, y: 0.5 * x + 0.2 * np.sin(y))
    path = tmp_path / "case.toml"
    path.write_text(text(3, more=SLAB))
    simulation, names = simulation_of(path)
    state = simulation.state()
    wall = state["body"] == names.index("terrain")
    assert (state["motion"][wall] == 1).all()
    volume = state["mass"][wall] / state["density"][wall]
    assert volume == pytest.approx(np.full(wall.sum(), 1e-3), rel=0.1)
    # Kernel sums over the walls below the middle of the slide are those of a half space.
    middle = np.array([1.5, 2.0, 0.75 + 0.2 * np.sin(2.0)])
    near = np.linalg.norm(state["position"][wall] - middle, axis=1) < 0.24
    assert volume[near].sum() == pytest.approx(2 / 3 * np.pi * 0.24**3, rel=0.12)


def test_walls_follow_the_flow_and_memory_does_not_grow(slide):
    simulation, names = simulation_of(slide)
    wall = names.index("terrain")
    counts, ends = [], []
    for _ in range(6):
        simulation.advance(limit=9.0, pause=simulation.time + 0.2, max_steps=10**6)
        state = simulation.state()
        own = state["body"] == wall
        x, water = state["position"][own][:, 0], state["position"][fluid(state)][:, 0]
        counts.append(int(own.sum()))
        ends.append((x.min(), x.max()))
        assert x.min() < water.min()
        assert x.max() > water.max()
    whole = 3 * 12.0 / 0.05
    assert ends[-1][0] > ends[0][0] + 0.3, "walls behind the slide stay"
    assert max(counts) < 0.6 * whole
    assert len(np.unique(state["id"])) == len(state["id"])


def test_nothing_gets_through_a_bumpy_bed(slide):
    simulation, _ = simulation_of(slide)
    simulation.advance(limit=1.2, pause=1.2, max_steps=10**6)
    state = simulation.state()
    position = state["position"][fluid(state)]
    assert len(position) == simulation.totals()["count"][0]
    assert (position[:, 1] > slope(position[:, 0]) - 0.025).all()


def test_a_run_that_is_restored_goes_on_with_the_same_bits(slide):
    simulation, names = simulation_of(slide)
    step(simulation, 150)
    kept = simulation.checkpoint()
    step(simulation, 150)
    other = empty_simulation(load_scenario(slide), names)
    assert other.restore(kept)
    step(other, 150)
    a, b = simulation.state(), other.state()
    assert all(np.array_equal(a[key], b[key]) for key in a)
    assert len(simulation.checkpoint()["terrain_tiles"]) >= 3


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("terrain_tiles", lambda tiles: tiles[::-1].copy()),
        ("terrain_tiles", lambda tiles: tiles + 10**6),
        ("terrain_tiles", lambda tiles: tiles[1:]),
        ("terrain_groups", lambda groups: groups[:-1]),
        ("terrain_groups", lambda groups: groups & ~np.uint64(1)),
        ("terrain_groups", lambda groups: groups | np.uint64(1 << 40)),
        ("point", lambda points: points - 10**6),
    ],
)
def test_tiles_of_another_terrain_are_refused(slide, name, change):
    simulation, names = simulation_of(slide)
    kept = simulation.checkpoint()
    other = empty_simulation(load_scenario(slide), names)
    with pytest.raises(ValueError, match=r"terrain_tiles|terrain_groups|point"):
        other.restore(kept | {name: change(kept[name])})


@pytest.mark.parametrize("shift", [(2048.0, 0.0), (460800.0, 2048.0)])
def test_a_shifted_map_gives_the_same_flow(tmp_path, shift):
    states = []
    for at in ((0.0, 0.0), shift):
        # Steps of 1/64 m are exact in both places.
        profile(tmp_path / "terrain.csv", lambda x: np.round(64 * slope(x)) / 64, cell=1 / 16,
                shift=at)  # fmt: skip
        path = tmp_path / "case.toml"
        between = f"between = [{0.5 + at[0]}, {1.5 + at[0]}]"
        more = SLIDE.replace("between = [0.5, 1.5]", between)
        path.write_text(text(2, dp=0.0625, speed=6.0, more=more))
        simulation, _ = simulation_of(path, ["terrain.resample=0.0625"])
        step(simulation, 200)
        states.append(simulation.state())
    near, far = states
    assert near["velocity"] == pytest.approx(far["velocity"], abs=1e-7)
    assert near["position"] + shift == pytest.approx(far["position"], abs=1e-8)


def test_a_mirrored_map_gives_the_mirrored_flow(tmp_path):
    """Columns are laid from the west, so that the two differ by rounding of their number."""
    centres = []
    for sign in (1, -1):
        profile(tmp_path / "terrain.csv", lambda x, s=sign: slope(s * x), *sorted((0.0, sign * 6)))
        path = tmp_path / "case.toml"
        between = sorted((sign * 0.5, sign * 1.5))
        path.write_text(text(2, dp=0.05, speed=6.0, more=SLIDE.replace("[0.5, 1.5]", str(between))))
        simulation, _ = simulation_of(path)
        simulation.advance(limit=0.8, pause=0.8, max_steps=10**6)
        state = simulation.state()
        centres.append((state["position"][fluid(state)] * [sign, 1]).mean(axis=0))
    assert centres[0] == pytest.approx(centres[1], rel=0.01)


def test_what_leaves_the_map_leaves_the_run(tmp_path):
    profile(tmp_path / "terrain.csv", lambda x: 1 - 0.5 * x, 0.0, 2.0)
    path = tmp_path / "case.toml"
    path.write_text(text(2, dp=0.05, speed=6.0, more=SLIDE))
    simulation, _ = simulation_of(path)
    before = simulation.totals()["mass"]
    simulation.advance(limit=0.9, pause=0.9, max_steps=10**6)
    after = simulation.totals()
    assert after["mass_left"] > 0.3 * before
    assert after["mass"] + after["mass_left"] == pytest.approx(before, rel=1e-12)
    state = simulation.state()
    assert state["position"][fluid(state)][:, 0].max() < 2.2


def test_a_ball_rolls_down_a_terrain_as_down_a_box(tmp_path):
    """A sphere without slip on a slope t gains 5/7 g sin t."""
    tilt = 0.3
    grid(tmp_path / "terrain.asc", lambda x, y: 3 - tilt * x)
    ball = """
[body.ball]
shape = "sphere"
material = "basalt"
centre = [1.0, 2.0, {z}]
radius = 0.2
[material.basalt]
friction = 0.9
rolling_friction = 0.0
restitution = 0.1
[body.pool]
shape = "release"
material = "water"
polygon = [[5, 3], [5.5, 3], [5.5, 3.5], [5, 3.5]]
thickness = 0.1
"""
    path = tmp_path / "case.toml"
    z = 3 - tilt * 1.0 + 0.2 * np.sqrt(1 + tilt**2)
    path.write_text(text(3, dp=0.1, more=ball.format(z=z)))
    simulation, _ = simulation_of(path)
    simulation.advance(limit=1.0, pause=1.0, max_steps=10**6)
    grains = simulation.grains()
    (moving,) = np.flatnonzero(~grains["fixed"])
    along = np.array([1, 0, -tilt]) / np.sqrt(1 + tilt**2)
    exact = 5 / 7 * 9.81 * tilt / np.sqrt(1 + tilt**2)
    assert grains["velocity"][moving] @ along == pytest.approx(exact, rel=0.02)
    centre = grains["centre"][moving]
    height = (centre[2] - (3 - tilt * centre[0])) / np.sqrt(1 + tilt**2)
    assert height == pytest.approx(0.2, rel=0.02)


def test_threads_and_steps_do_not_change_what_is_made(slide):
    states = []
    for _ in range(2):
        simulation, _ = simulation_of(slide)
        step(simulation, 60)
        states.append(simulation.state())
    assert all(np.array_equal(states[0][key], states[1][key]) for key in states[0])


def test_the_scheme_of_the_paper_has_no_terrain(slide):
    from doseki.errors import UserError

    with pytest.raises(UserError, match="terrain"):
        filled_simulation(load_scenario(slide, ["scheme=ueta2022", "xi=0.05"]))


def test_what_has_gone_through_the_ground_is_taken_out_and_told(slide):
    """Not what is within the walls; a checkpoint goes on with this account."""
    simulation, names = simulation_of(slide)
    step(simulation, 20)
    saved = {name: np.array(values) for name, values in simulation.checkpoint().items()}
    free = np.flatnonzero(saved["motion"] == 0)
    mass = simulation.totals()["mass"]
    for below, gone in ((0.05, 0), (5.0, 2)):
        state = {name: values.copy() for name, values in saved.items()}
        state["position"][free[:2], 1] -= below
        other = empty_simulation(load_scenario(slide), names)
        check_state(other, state, 2, len(names))
        other.restore(state)
        end = other.time + 0.3
        other.advance(limit=end, pause=end, max_steps=10**6)
        totals = other.totals()
        taken = saved["mass"][free[:gone]].sum()
        assert totals["mass_through_ground"] == pytest.approx(taken, rel=1e-12)
        assert totals["mass"] == pytest.approx(mass - taken, rel=1e-12)
        assert other.checkpoint()["through_ground"][0] == totals["mass_through_ground"]
