"""A stream without friction passes joints of its bed as if they were none."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows

# Water 8 particles deep on a bed without friction that is periodic along it.
STREAM = """\
dim = 2
scheme = "resolved"
speed_max = 3
dp = 0.01
time_max = 1
time_out = 1
gravity = [0, -9.81]
periodic = ["x"]
domain_min = [0, -9]
domain_max = [0.4, 9]

[body.stream]
shape = "box"
material = "water"
pressure = "= 9810*(0.08 - y)"
min = [0, 0]
max = [0.4, 0.08]
velocity = [2.5, 0]
"""
WALL = '\n[body.{}]\nmaterial = "aluminium"\nfixed = true\nwall = "free_slip"\n{}\n'


def polygon(name, left, right, depth=0.04):
    corners = [[left, -depth], [right, -depth], [right, 0], [left, 0]]
    return WALL.format(name, f'shape = "polygon"\nvertices = {corners}')


def box(name, left, right, depth=0.04):
    return WALL.format(name, f'shape = "box"\nmin = [{left}, -{depth}]\nmax = [{right}, 0]')


BEDS = {
    "one box": box("a", 0, 0.4),
    "polygons": polygon("a", 0, 0.2) + polygon("b", 0.2, 0.4),
    "polygon and box": polygon("a", 0, 0.2) + box("b", 0.2, 0.4),
    "thick beside thin": box("a", 0, 0.2, 0.12) + box("b", 0.2, 0.4, 0.03),
}


@pytest.mark.parametrize("bed", BEDS)
def test_a_stream_keeps_its_speed_over_joints(tmp_path, bed):
    simulation = Flows(tmp_path)(STREAM + BEDS[bed])
    simulation.advance(limit=0.2, pause=0.2, max_steps=10**6)
    state = simulation.state()
    moving = np.asarray(state["motion"]) == 0
    speed, height = state["velocity"][moving, 0], state["position"][moving, 1]
    assert speed[height < 0.02].mean() > 0.998 * 2.5
    assert speed.mean() > 0.999 * 2.5


# Water that falls over a wall without friction, and leaves its foot.
POND = """\
dim = 2
scheme = "resolved"
speed_max = 4
dp = 0.01
time_max = 1
time_out = 1
gravity = [0, -9.81]

[body.water]
shape = "box"
material = "water"
min = [-0.4, 0]
max = [0, 0.25]
"""
LOSS = 0.08  # of the energy, in the splash behind the wall


@pytest.mark.parametrize("rows", [3, 8])
def test_a_thin_box_is_the_wall_that_a_polygon_is(tmp_path, rows):
    """Its crest and its far side count: a box of up to eight rows had one face, and 11 % went."""
    width, height = 0.01 * rows, 0.12
    shores = box("bed", -0.6, 1.2, 0.1)
    shores += WALL.format("left", 'shape = "box"\nmin = [-0.6, 0]\nmax = [-0.4, 0.5]')
    corners = [[0, 0], [width, 0], [width, height], [0, height]]
    walls = {
        "box": f'shape = "box"\nmin = [0, 0]\nmax = [{width}, {height}]',
        "polygon": f'shape = "polygon"\nvertices = {corners}',
    }
    energies = []
    for keys in walls.values():
        simulation = Flows(tmp_path)(POND + shores + WALL.format("wall", keys))
        simulation.advance(limit=0.4, pause=0.4, max_steps=10**6)
        state = simulation.state()
        moving = np.asarray(state["motion"]) == 0
        speed = np.linalg.norm(state["velocity"][moving], axis=1)
        height_now = state["position"][moving, 1]
        energies.append(state["mass"][moving] @ (0.5 * speed**2 + 9.81 * height_now))
    first = 1000 * 9.81 * 0.4 * 0.25**2 / 2
    assert energies[0] == pytest.approx(energies[1], rel=2e-3)
    assert energies[0] > (1 - LOSS) * first


@pytest.mark.parametrize("turn", [25.0, 180.0])
def test_a_thin_box_is_the_same_wall_in_a_turned_scene(tmp_path, turn):
    """All of the scene and gravity, about the foot of the wall."""
    shores = box("bed", -0.6, 1.2, 0.1)
    shores += WALL.format("left", 'shape = "box"\nmin = [-0.6, 0]\nmax = [-0.4, 0.5]')
    scene = POND + shores + WALL.format("wall", 'shape = "box"\nmin = [0, 0]\nmax = [0.03, 0.12]')
    energies = []
    for degrees in (0.0, turn):
        angle = np.radians(degrees)
        up = np.array([-np.sin(angle), np.cos(angle)])
        turned = scene.replace(
            'shape = "box"', f'shape = "box"\nrotate = {degrees}\npivot = [0, 0]'
        )
        turned = turned.replace("gravity = [0, -9.81]", f"gravity = {(-9.81 * up).tolist()}")
        simulation = Flows(tmp_path)(turned)
        simulation.advance(limit=0.3, pause=0.3, max_steps=10**6)
        state = simulation.state()
        moving = np.asarray(state["motion"]) == 0
        speed = np.linalg.norm(state["velocity"][moving], axis=1)
        height = state["position"][moving] @ up
        energies.append(state["mass"][moving] @ (0.5 * speed**2 + 9.81 * height))
    assert energies[1] == pytest.approx(energies[0], rel=2e-3)


# The same in space, in a channel whose walls are without friction too.
CHANNEL = """\
dim = 3
scheme = "resolved"
speed_max = 3
dp = 0.01
time_max = 1
time_out = 1
gravity = [0, 0, -9.81]
periodic = ["x"]
domain_min = [0, -9, -9]
domain_max = [0.08, 9, 9]

[body.stream]
shape = "box"
material = "water"
pressure = "= 9810*(0.04 - z)"
min = [0, 0, 0]
max = [0.08, 0.06, 0.04]
velocity = [2.5, 0, 0]
"""
THICK = 0.03  # m, of its walls: as the kernel reaches


@pytest.mark.parametrize("kind", ["box", "stl"])
@pytest.mark.parametrize("stands", ["on the floor", "beside the floor"])
def test_a_stream_keeps_its_speed_along_a_corner(tmp_path, kind, stands):
    import trimesh

    foot, beyond = (0.0, 0.1) if stands == "on the floor" else (-THICK, 0.0)
    sides = {
        "floor": [(0, -beyond, -THICK), (0.08, 0.06 + beyond, 0)],
        "left": [(0, -0.1, foot), (0.08, 0, 0.1)],
        "right": [(0, 0.06, foot), (0.08, 0.16, 0.1)],
    }
    text = CHANNEL
    for name, (low, high) in sides.items():
        keys = f'shape = "box"\nmin = {list(low)}\nmax = {list(high)}'
        if kind == "stl":
            trimesh.creation.box(bounds=[low, high]).export(tmp_path / f"{name}.stl")
            keys = f'shape = "stl"\nfile = "{name}.stl"'
        text += WALL.format(name, keys)
    simulation = Flows(tmp_path)(text)
    simulation.advance(limit=0.1, pause=0.1, max_steps=10**6)
    state = simulation.state()
    place, speed = state["position"], state["velocity"][:, 0]
    moving = np.asarray(state["motion"]) == 0
    corner = moving & (place[:, 2] < 0.02) & (np.abs(place[:, 1] - 0.03) > 0.01)
    assert speed[corner].mean() > 0.998 * 2.5
    assert speed[moving].mean() > 0.999 * 2.5
