"""Films and channels on maps, oblique to them and far from zero, against walls of particles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from .scenes import fluid, grid, simulation_of

TILT, BANK = math.radians(20), math.tan(math.radians(30))
HEAD = """
dim = 3
dp = 0.05
time_max = 1
time_out = 1
scheme = "resolved"
gravity = [0, 0, -9.81]
speed_max = 3.0
[material.oil]
based_on = "water"
nu = {nu}
[body.oil]
shape = "box"
material = "oil"
rotate = {turn}
rotate_axis = {axis}
pivot = {foot}
min = {low}
max = {high}
"""
MAP = """
[terrain]
file = "terrain.asc"
material = "basalt"
wall = "{wall}"
{ks}
"""
BOX = """
[body.bed]
shape = "box"
material = "basalt"
fixed = true
wall = "{wall}"
{ks}
min = {low}
max = {high}
rotate = {turn}
rotate_axis = {axis}
pivot = {foot}
"""
MESH = """
[body.bed]
shape = "mesh"
file = "trough.stl"
material = "basalt"
fixed = true
wall = "{wall}"
{ks}
"""


def frame(angle):
    """Unit vectors down a slope of 20 degrees, aside and up, as columns; `angle` is in plan."""
    plan = math.radians(angle)
    down = np.array([math.cos(plan), math.sin(plan), -math.tan(TILT)]) * math.cos(TILT)
    aside = np.array([-math.sin(plan), math.cos(plan), 0.0])
    return np.column_stack([down, aside, np.cross(down, aside)])


def trough(path, axes, foot):
    """A channel with banks of 30 degrees to the slope, 0.4 m deep below its bed, as a mesh."""
    around = np.array([[-1, BANK], [0, 0], [1, BANK], [1, -0.4], [-1, -0.4]])
    ends = [np.column_stack([np.full(5, x), around]) @ axes.T + foot for x in (-1.0, 3.0)]
    faces = [(0, [0, 1, 4]), (0, [1, 3, 4]), (0, [1, 2, 3])]
    triangles = [ends[0][k] for _, k in faces] + [ends[1][k[::-1]] for _, k in faces]
    for a in range(5):
        b = (a + 1) % 5
        triangles += [np.array([ends[0][a], ends[1][a], ends[1][b]])]
        triangles += [np.array([ends[0][a], ends[1][b], ends[0][b]])]
    volume = sum(np.linalg.det(t - foot) for t in triangles)
    lines = ["solid trough"]
    for triangle in triangles:
        corners = triangle if volume > 0 else triangle[::-1]
        vertices = "\n".join(f"vertex {x!r} {y!r} {z!r}" for x, y, z in corners.tolist())
        lines += ["facet normal 0 0 0", "outer loop", vertices, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid trough", ""]))


def way(folder, bed, angle, shift=(0.0, 0.0, 0.0), wall="no_slip", bank=0.0, nu=0.05):
    """How far the middle of the oil goes down, aside and up in half a second, m.

    `bed` is "map" or "particles"; a channel has the slope `bank` of its banks to its bed.
    """
    axes, foot = frame(angle), np.array([2.0, 2.0, 2.0]) + shift
    turn = Rotation.from_matrix(axes).as_rotvec()
    by = np.linalg.norm(turn)
    places = {"turn": math.degrees(by), "axis": (turn / by).tolist(), "foot": foot.tolist()}
    half, deep = (0.7, 0.4) if bank else (0.6, 0.3)
    local = np.array([[-0.6, -half, 0.0], [0.6, half, deep]]) + foot
    words = HEAD.format(low=local[0].tolist(), high=local[1].tolist(), nu=nu, **places)
    if bank:
        e, n = (
            "(" + " + ".join(f"{c!r}*({x} - {f!r})" for c, x, f in
                             zip(axes[:, k].tolist(), "xyz", foot.tolist(), strict=True)) + ")"
            for k in (1, 2)
        )  # fmt: skip
        words = words.replace("[body.oil]", f'[body.oil]\nwhere = "= {n} - {bank}*abs({e}) - 0.03"')
    keys = {"wall": wall, "ks": "ks = 0.02" if wall == "rough" else ""}
    if bed == "map":
        normals = [axes[:, 2] - side * bank * axes[:, 1] for side in (1, -1)]

        def height(x, y):
            planes = [-(m[0] * (x - 2) + m[1] * (y - 2)) / m[2] for m in normals]
            return 2 + np.maximum(*planes)

        grid(folder / "terrain.asc", height, (4.0, 4.0), 0.05, shift)
        words = words.replace("[material.oil]", MAP.format(**keys) + "[material.oil]")
    elif bank:
        trough(folder / "trough.stl", axes, foot)
        words += MESH.format(**keys)
    else:
        low, high = foot + np.array([[-1.0, -1.0, -0.15], [2.5, 1.0, 0.0]])
        words += BOX.format(low=low.tolist(), high=high.tolist(), **keys, **places)
    path = folder / "case.toml"
    path.write_text(words)
    simulation, _ = simulation_of(path)
    state = simulation.state()
    start = state["position"][fluid(state)].mean(axis=0)
    simulation.advance(limit=0.5, pause=0.5, max_steps=10**6)
    state = simulation.state()
    return (state["position"][fluid(state)].mean(axis=0) - start) @ axes


PLACES = [(0.0, (0.0, 0.0, 0.0)), (-37.0, (0.0, 0.0, 0.0)), (-37.0, (460800.0, 2048.0, 512.0))]


@pytest.mark.validate
@pytest.mark.parametrize(("wall", "bank"), [("no_slip", 0.0), ("rough", 0.0), ("no_slip", BANK)])
def test_oil_on_a_map_goes_as_far_as_on_particles(tmp_path, wall, bank):
    """Within 2 % as a layer and in a channel, along the axes of the map, oblique, far away."""
    exact = way(tmp_path, "particles", 0.0, wall=wall, bank=bank)[0]
    assert exact > 0.2
    for angle, shift in PLACES:
        down, aside, _ = way(tmp_path, "map", angle, np.array(shift), wall, bank)
        assert down == pytest.approx(exact, rel=0.02)
        assert abs(aside) < 0.005 * exact


@pytest.mark.validate
def test_thinner_oil_is_told_apart(tmp_path):
    """The control: a tenth less viscosity."""
    thin = way(tmp_path, "map", -37.0, nu=0.045)[0]
    assert thin > 1.03 * way(tmp_path, "particles", 0.0)[0]
