"""Water against walls of triangles: at rest, tilted, behind a sheet, and through no gap."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from doseki.scene.meshes.making import made_mesh

from ..flows import Flows

G, DP = 9.81, 0.05
WEIGHT = 1000 * G * 0.6 * 0.3 * 0.3
HEAD = """\
dim = 3
scheme = "resolved"
speed_max = 2
dp = 0.05
time_max = 1
time_out = 1
relax = {relax}
gravity = {gravity}

[body.water]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [0.6, 0.3, 0.3]
{water}
"""
MESH = """
[body.{name}]
shape = "mesh"
material = "basalt"
file = "{name}.ply"
{keys}
"""
TANK = """
[body.tank]
shape = "tank"
material = "basalt"
min = [0, 0, 0]
max = [0.6, 0.3, 0.45]
"""


def mesh_body(folder: Path, name: str, mesh: trimesh.Trimesh, keys: str = "") -> str:
    mesh.export(folder / f"{name}.ply", vertex_normal=False)
    return MESH.format(name=name, keys=keys)


def open_tank() -> trimesh.Trimesh:
    """The walls of TANK as one closed surface."""
    outer = np.array([[-0.15, -0.15, -0.15], [0.75, 0.45, 0.45]])
    inner = np.array([[0, 0, 0], [0.6, 0.3, 0.45]])
    vertices = np.array([
        [box[i, 0], box[j, 1], box[k, 2]]
        for box in (outer, inner) for k in (0, 1) for j in (0, 1) for i in (0, 1)
    ])  # fmt: skip
    quads = [(0, 2, 3, 1), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]
    inside = [tuple(8 + v for v in reversed(quad)) for quad in quads]
    rim = [(4, 5, 13, 12), (5, 7, 15, 13), (7, 6, 14, 15), (6, 4, 12, 14)]
    faces = [f for a, b, c, d in (*quads, *inside, *rim) for f in ((a, b, c), (a, c, d))]
    return trimesh.Trimesh(vertices, faces, process=False)


def simulation_of(folder: Path, text: str, *, relax: float = 0.4, **values: Any) -> Any:
    defaults = {"gravity": [0.0, 0.0, -G], "water": 'pressure = "= 9810*(0.3 - z)"'}
    return Flows(folder)(HEAD.format(**defaults | values, relax=relax) + text)


def to(simulation: Any, time: float) -> Any:
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    return simulation


def force_on(simulation: Any, *bodies: int) -> np.ndarray:
    """Mean of ten readings of the force (3,) on bodies, all walls by default."""
    total = np.zeros(3)
    for n in range(10):
        state = to(simulation, 0.1 + 0.01 * n).state()
        mine = (state["motion"] == 1) & (np.isin(state["body"], bodies) | (not bodies))
        total += state["force"][mine].sum(axis=0) / 10
    return total


def test_water_at_rest_presses_on_a_mesh_as_on_boxes(tmp_path):
    (tmp_path / "box").mkdir()
    on_boxes = force_on(simulation_of(tmp_path / "box", TANK))
    on_mesh = force_on(simulation_of(tmp_path, mesh_body(tmp_path, "tank", open_tank())))
    assert on_mesh[2] == pytest.approx(-WEIGHT, rel=0.01)
    assert on_mesh == pytest.approx(on_boxes, abs=0.01 * WEIGHT)


@pytest.mark.parametrize("how", ["in its file", "by rotate"])
def test_a_mesh_turned_with_gravity_and_water_is_pressed_alike(tmp_path, how):
    turn = trimesh.transformations.rotation_matrix(np.radians(-30), [0, 1, 0])
    mesh = open_tank()
    text = mesh_body(tmp_path, "tank", mesh, "rotate = 30")
    if how == "in its file":
        text = mesh_body(tmp_path, "tank", mesh.apply_transform(turn))
    down = turn[:3, :3] @ [0, 0, -G]
    up = f'pressure = "= 1000*({down[0]}*x + {down[2]}*z) + 2943"\nrotate = 30'
    simulation = simulation_of(tmp_path, text, gravity=down.tolist(), water=up)
    force = force_on(simulation) @ turn[:3, :3]
    assert force == pytest.approx([0, 0, -WEIGHT], abs=0.01 * WEIGHT)


def test_water_in_a_tilted_mesh_with_gravity_upright_runs_to_one_side(tmp_path):
    """What the test above would see were walls or gravity not turned."""
    text = mesh_body(tmp_path, "tank", open_tank(), "rotate = 30")
    simulation = simulation_of(tmp_path, text, relax=0.05, water="rotate = 30")
    state = to(simulation, 0.15).state()
    assert np.linalg.norm(state["velocity"][state["motion"] == 0], axis=1).max() > 0.3


def dam() -> trimesh.Trimesh:
    """Slanted on both sides and standing askew across the tank."""
    ends = [(x + 0.3 * y, y, z) for x, z in ((0.15, -0.1), (0.5, -0.1), (0.4, 0.5), (0.3, 0.5))
            for y in (-0.1, 0.4)]  # fmt: skip
    return trimesh.convex.convex_hull(np.array(ends))


def inside_of(file: Path, position: np.ndarray) -> int:
    made = made_mesh(file, 1.0, 0.0)
    return int(made.shape.contains(position - made.middle).sum())


@pytest.mark.parametrize("there", [True, False])
def test_no_water_goes_into_or_through_a_slanted_mesh(tmp_path, there):
    """Water stands on the left side alone; without the dam it runs across: the control."""
    water = 'max = [0.25, 0.3, 0.3]\nwhere = "= 0.2 + 0.3*y - x + 0.28*z"'
    text = mesh_body(tmp_path, "dam", dam(), "" if there else "enabled = false")
    text = HEAD.replace("max = [0.6, 0.3, 0.3]\n", "") + TANK + text
    text = text.replace("relax = {relax}\n", "")
    values = {"gravity": [0, 0, -G], "water": water}
    simulation = to(Flows(tmp_path)(text.format(**values)), 0.6)
    state = simulation.state()
    position = state["position"][state["motion"] == 0]
    assert len(position) > 100
    inside = inside_of(tmp_path / "dam.ply", position)
    beyond = (position[:, 0] > 0.45 + 0.3 * position[:, 1]).sum()
    assert (inside == 0) == there
    assert (beyond == 0) == there


TWO_DEPTHS = """\
dim = 3
scheme = "resolved"
speed_max = 3
dp = 0.05
time_max = 1
time_out = 1
relax = 0.6
gravity = [0, 0, -9.81]

[body.deep]
shape = "box"
material = "water"
min = [{left_end}, 0, 0]
max = [{left}, 0.3, 0.4]
pressure = "= 9810*(0.4 - z)"

[body.shallow]
shape = "box"
material = "water"
min = [{right}, 0, 0]
max = [{right_end}, 0.3, 0.2]
pressure = "= 9810*(0.2 - z)"

[body.tank]
shape = "tank"
material = "basalt"
min = [{left_end}, 0, 0]
max = [{right_end}, 0.3, 0.55]
"""
WALL = """
[body.wall]
shape = "box"
material = "basalt"
fixed = true
normal = [{side}, 0, 0]
min = [{low}, 0, 0]
max = [{high}, 0.3, 0.55]
"""


@pytest.mark.parametrize("thickness", [0.15, 0.3])
def test_a_sheet_parts_water_of_two_depths(tmp_path, thickness):
    """As a wall of that thickness does; no water gets to the other side."""
    left, right = 0.6 - 0.5 * thickness, 0.6 + 0.5 * thickness
    ends = {"left": left, "right": right, "left_end": left - 0.45, "right_end": right + 0.45}
    text = TWO_DEPTHS.format(**ends)
    plane = trimesh.Trimesh(
        [[0.6, y, z] for y in (-0.15, 0.45) for z in (-0.15, 0.6)], [[0, 1, 2], [1, 3, 2]]
    )
    keys = "sheet = true" + (f"\nthickness = {thickness}" if thickness > 0.15 else "")
    (tmp_path / "wall").mkdir()
    wall = WALL.format(low=left, high=right, side=-1)
    as_wall = Flows(tmp_path / "wall")(text + wall)
    simulation = Flows(tmp_path)(text + mesh_body(tmp_path, "sheet", plane, keys))
    of_wall, force = (force_on(s, int(s.state()["body"].max())) for s in (as_wall, simulation))
    exact = 0.5 * 1000 * G * 0.3 * (0.4**2 - 0.2**2)
    assert force[0] == pytest.approx(exact, rel=0.15), "corners share it with the tank"
    assert force[0] == pytest.approx(of_wall[0], abs=0.03 * exact)
    state = simulation.state()
    water = state["motion"] == 0
    x, body = state["position"][water, 0], state["body"][water]
    assert ((x < 0.6) == (body == body.min())).all()
