"""Walls that thin to nothing on others: below both are rows, half a spacing deep and so on."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from doseki.record.particles import FIXED as FIXED_MOTION
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.scene import build
from doseki.scene.walls.normals import wall_geometry
from doseki.solver.build import build_simulation

from ..small_scenarios import MINIMAL
from .test_covered_faces import FIXED, WATER, box, polygon, rotation

DP = 0.05
TOP = 'scheme = "resolved"\nspeed_max = 2'
BED = ((-1, -0.5), (5, 0))


class Ramp:
    """Particles of a bed and of a ramp on it, as far as the ramp is 3.5 spacings thick.

    In a frame in which its bed is level; `depth` in spacings below the surface of both.
    """

    def __init__(self, write, tables, slope, turn=0, dim=2):
        water = WATER.format(low=[-9] * dim, high=[-8.5] * dim)
        scenario = load_scenario(write(top=TOP, tables=tables + water), [f"dim={dim}", f"dp={DP}"])
        scene = build.build_scene(scenario)
        found = wall_geometry(scenario, scene.particles, scene.names, scene.bodies)
        back = rotation(turn) if dim == 2 else np.eye(3)
        x, cosine = scene.particles.position @ back, 1 / np.hypot(1, slope)
        self.depth = (slope * x[:, 0] - x[:, -1]) * cosine / DP
        on_ramp = (
            (x[:, 0] > 0.3)
            & (x[:, 0] < min(3.5, 3.5 * DP / slope))
            & (self.depth < 2.6)
            & (self.depth > 0)
        )
        if dim == 3:
            on_ramp &= np.abs(x[:, 1]) < 0.3
        self.x, self.depth = x[on_ramp], self.depth[on_ramp]
        self.normal, self.told = (found.normal @ back)[on_ramp], found.depth[on_ramp] / DP
        self.up = np.array([-slope, *[0] * (dim - 2), 1]) * cosine


def lie_in_rows(ramp):
    """Whether all are half a spacing below the surface, or whole spacings more."""
    return np.abs(ramp.depth - 0.5 - np.rint(ramp.depth - 0.5)).max() < 0.12


def on_a_bed(slope, turn=0):
    corners = [(0, 0), (4, 0), (4, 4 * slope)]
    return polygon("ramp", corners, turn) + box("bed", *BED, turn)


@pytest.mark.parametrize("slope", [0.03, 0.06, 0.1])
@pytest.mark.parametrize("turn", [0, 25])
def test_a_ramp_and_its_bed_have_common_rows(write, slope, turn):
    ramp = Ramp(write, on_a_bed(slope, turn), slope, turn)
    assert lie_in_rows(ramp)
    assert np.abs(ramp.told - ramp.depth).max() < 1e-9
    assert np.abs(ramp.normal - ramp.up).max() < 1e-9
    for row in range(2):  # each is there from one end to the other
        along = np.sort(ramp.x[np.abs(ramp.depth - 0.5 - row) < 0.2, 0])
        assert np.diff(along).max() < 1.6 * DP
        assert np.diff(along).min() > 0.5 * DP


def test_without_them_the_bed_is_a_stair(write, monkeypatch):
    monkeypatch.setattr(build, "ways_into_rows", lambda *_: {})
    assert not lie_in_rows(Ramp(write, on_a_bed(0.06), 0.06))


def test_a_hump_has_both_sides(write):
    hump = polygon("ramp", [(0, 0), (8, 0), (4, 0.4)]) + box("bed", (-1, -0.5), (9, 0))
    up = Ramp(write, hump, 0.1)
    assert lie_in_rows(up)


def test_a_ramp_in_space(write, tmp_path):
    flat = np.array([(x, y, 0) for x in (0, 4) for y in (-0.5, 0.5)])
    corners = np.concatenate([flat, [(4, -0.5, 0.4), (4, 0.5, 0.4)]])
    trimesh.convex.convex_hull(corners).export(tmp_path / "ramp.stl")
    ramp = FIXED.format(name="ramp", keys='shape = "stl"\nfile = "ramp.stl"')
    found = Ramp(write, ramp + box("bed", (-1, -1, -0.5), (5, 1, 0)), 0.1, dim=3)
    assert lie_in_rows(found)
    assert np.abs(found.normal - found.up).max() < 1e-6


@pytest.mark.parametrize("rows", [2, 3])
def test_a_thin_bed_goes_along(write, rows):
    """Its lower rows are as near to its other side."""
    corners = [(0, 0), (4, 0), (4, 0.4)]
    ramp = Ramp(write, polygon("ramp", corners) + box("bed", (-1, -rows * DP), (5, 0)), 0.1)
    assert lie_in_rows(ramp)
    assert np.abs(ramp.normal - ramp.up).max() < 1e-9


def test_a_ramp_over_a_seam_is_one_ramp(write):
    """In a domain of 5 m, from 4 to 6: its particles come in at the other end."""
    domain = 'periodic = ["x"]\ndomain_min = [0, -9.5]\ndomain_max = [5, 9.5]'
    parts = []
    for start in (1.0, 4.0):
        corners = [(start, 0), (start + 2, 0), (start + 2, 0.2)]
        tables = polygon("ramp", corners) + box("bed", (0, -0.5), (5, 0))
        tables += WATER.format(low=[0.5, 8.5], high=[1, 9])
        scenario = load_scenario(write(top=f"{TOP}\n{domain}", tables=tables), [f"dp={DP}"])
        scene = build.build_scene(scenario)
        found = wall_geometry(scenario, scene.particles, scene.names, scene.bodies)
        x = scene.particles.position[:, 0] - start
        fixed = scene.particles.motion == FIXED_MOTION
        table = np.column_stack(
            [np.round(x % 5, 6), scene.particles.position[:, 1], found.normal, found.depth]
        )[fixed]
        parts.append(table[np.lexsort(table[:, 1::-1].T)])
    assert len(parts[0]) == len(parts[1])
    np.testing.assert_allclose(parts[1], parts[0], atol=1e-6)


def test_a_ramp_that_moves_off_its_bed_leaves_it_as_it_is(write):
    goes = polygon("ramp", [(0, 0), (4, 0), (4, 0.4)], more="motion = { velocity = [1, 0] }")
    assert not lie_in_rows(Ramp(write, goes + box("bed", *BED), 0.1))


def test_a_run_that_starts_from_another_has_the_same_walls(tmp_path):
    tables = on_a_bed(0.1) + WATER.format(low=[1, 1], high=[1.5, 1.2])
    (tmp_path / "first.toml").write_text(f"{MINIMAL}{TOP}\n{tables}")
    first = load_scenario(str(tmp_path / "first.toml"), [f"dp={DP}", "time_max=0.01"])
    run_scenario(first, tmp_path / "run", RunOptions(threads=1))
    start = '[start]\nfrom = "run"\n'
    (tmp_path / "next.toml").write_text(f"{MINIMAL}{TOP}\n{tables}{start}")
    states = []
    for scenario in (first, load_scenario(str(tmp_path / "next.toml"), [f"dp={DP}"])):
        state = build_simulation(scenario)[0].state()
        fixed = np.asarray(state["motion"]) == 1
        states.append({key: state[key][fixed] for key in ("id", "position", "normal")})
    for key, values in states[0].items():
        np.testing.assert_allclose(states[1][key], values, atol=1e-12)


def test_a_ramp_that_is_added_finds_its_bed_where_it_was(tmp_path):
    bed = box("bed", *BED) + WATER.format(low=[1, 1], high=[1.5, 1.2])
    (tmp_path / "first.toml").write_text(f"{MINIMAL}{TOP}\n{bed}")
    first = load_scenario(str(tmp_path / "first.toml"), [f"dp={DP}", "time_max=0.01"])
    run_scenario(first, tmp_path / "run", RunOptions(threads=1))
    ramp = polygon("ramp", [(0, 0), (4, 0), (4, 0.4)])
    (tmp_path / "next.toml").write_text(f'{MINIMAL}{TOP}\n{bed}{ramp}[start]\nfrom = "run"\n')
    scenario = load_scenario(str(tmp_path / "next.toml"), [f"dp={DP}"])
    state = build_simulation(scenario)[0].state()
    x, normal = state["position"], state["normal"]
    below = (np.asarray(state["motion"]) == 1) & (x[:, 1] > -DP) & (x[:, 1] < 0)
    below &= (x[:, 0] > 0.2) & (x[:, 0] < 1)
    assert below.any()
    assert np.abs(normal[below, 0] + 0.1 / np.hypot(1, 0.1)).max() < 1e-9
