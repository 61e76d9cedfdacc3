"""Normals and depths of walls, as the resolved scheme has them from the shapes of bodies."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.particles import FIXED
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies, build_scene
from doseki.scene.walls.normals import wall_geometry

BALL = """
[body.water]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [1, 1, 1]

[body.disc]
shape = "sphere"
material = "basalt"
fixed = true
centre = [3, 0, 0]
radius = 0.5
"""
FAST = 'scheme = "resolved"\nspeed_max = 2'
WATER = """
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [2, 1]
"""


def built(path):
    """Scenario, particles and names of the bodies: the arguments of wall_geometry."""
    scenario = load_scenario(path)
    return scenario, *build_bodies(scenario)


def wall(name, low, high, more=""):
    """The table of a fixed box."""
    return (
        f'\n[body.{name}]\nshape = "box"\nmaterial = "basalt"\nfixed = true\n'
        f"min = {list(low)}\nmax = {list(high)}\n{more}\n"
    )


@pytest.fixture
def geometry(write):
    """Positions, normals and depths of the particles of a body."""

    def of(name, tables):
        scenario, particles, names = built(write(top=FAST, tables=tables))
        normal, depth, _ = wall_geometry(scenario, particles, names)
        free = particles.motion == 0
        assert (normal[free] == 0).all()
        assert (depth[free] == 0).all()
        mine = particles.body == names.index(name)
        return particles.position[mine], normal[mine], depth[mine]

    return of


@pytest.mark.parametrize(
    ("low", "high", "normal", "surface"),
    [
        ((0, -0.1), (2, 0), (0, 1), 0.0),  # a floor
        ((0, 1), (2, 1.1), (0, -1), -1.0),  # a lid
        ((-0.1, 0), (0, 1.5), (1, 0), 0.0),  # a wall on the left
        ((2, 0), (2.1, 1.5), (-1, 0), -2.0),  # and on the right
    ],
)
def test_one_row_faces_the_water(geometry, low, high, normal, surface):
    """Both of its faces are as near."""
    x, n, depth = geometry("slab", WATER + wall("slab", low, high))
    np.testing.assert_array_equal(n, np.broadcast_to(normal, x.shape))
    np.testing.assert_allclose(depth, surface - x @ np.array(normal), atol=1e-12)
    np.testing.assert_allclose(depth, 0.05)


@pytest.mark.parametrize("rows", [2, 3, 8])
def test_a_thin_wall_has_two_faces_and_a_crest(geometry, rows):
    """Water goes over it."""
    x, n, depth = geometry("wall", WATER + wall("wall", (3, 0), (3 + 0.1 * rows, 1)))
    top = x[:, 1] > 0.94
    assert (n[top, 1] > 0.7).all()
    middle = np.abs(x[:, 1] - 0.5) < 0.06
    left = middle & (x[:, 0] < 3.05 + 1e-9)
    right = middle & (x[:, 0] > 2.95 + 0.1 * rows - 1e-9)
    assert (n[left] == [-1, 0]).all()
    assert (n[right] == [1, 0]).all()
    np.testing.assert_allclose(depth[left | right | top], 0.05)


def test_a_block_faces_outwards_on_every_side(geometry):
    x, n, depth = geometry("block", WATER + wall("block", (3, 0), (5, 1)))
    gaps = np.stack([x[:, 0] - 3, 5 - x[:, 0], x[:, 1], 1 - x[:, 1]])
    np.testing.assert_allclose(depth, gaps.min(axis=0), atol=1e-12)
    faces = np.array([(-1, 0), (1, 0), (0, -1), (0, 1)], float)
    nearest = np.isclose(gaps, depth).T
    assert (nearest.sum(axis=1) == 2).sum() == 4 * 5  # beside an edge
    expected = nearest @ faces / np.sqrt(nearest.sum(axis=1))[:, None]
    np.testing.assert_allclose(n, expected, atol=1e-12)


def test_a_block_on_a_floor_has_no_face_below(geometry):
    tables = WATER + wall("floor", (2, -0.3), (6, 0)) + wall("block", (3, 0), (5, 1))
    x, n, depth = geometry("block", tables)
    assert (n[:, 1] >= 0).all()
    gaps = np.stack([x[:, 0] - 3, 5 - x[:, 0], 1 - x[:, 1]])
    np.testing.assert_allclose(depth, gaps.min(axis=0), atol=1e-12)


DISC = """
[body.disc]
shape = "disc"
material = "basalt"
fixed = true
centre = [4, 1]
radius = 0.5
"""


def test_a_disc_that_is_cut_faces_outwards(geometry):
    x, n, depth = geometry("disc", WATER + DISC + "jitter = 0.1\n")
    out = x - [4, 1]
    distance = np.linalg.norm(out, axis=1)
    np.testing.assert_allclose(depth, 0.5 - distance, atol=1e-12)
    np.testing.assert_allclose(n * distance[:, None], out, atol=1e-12)


@pytest.mark.parametrize(("dim", "measure"), [(2, np.pi / 4), (3, np.pi / 6)])
def test_a_fixed_ball_is_as_large_as_one_that_moves(write, dim, measure):
    tables = WATER + DISC if dim == 2 else BALL
    scenario = load_scenario(write(top=FAST, tables=tables), [f"dim={dim}"])
    scene = build_scene(scenario)
    particles, mine = scene.particles, scene.particles.body == scene.names.index("disc")
    volume = particles.mass[mine] / particles.density[mine]
    assert volume.sum() == pytest.approx(measure)
    assert (particles.motion[mine] == FIXED).all()
    assert scene.bodies.shaped[mine].all()
    out = particles.position[mine] - scenario.body["disc"].centre
    distance = np.linalg.norm(out, axis=1)
    np.testing.assert_allclose(scene.bodies.depth[mine], 0.5 - distance, atol=1e-12)
    np.testing.assert_allclose(scene.bodies.normal[mine] * distance[:, None], out, atol=1e-12)


@pytest.mark.parametrize("angle", [30, -70])
def test_a_rotated_row_faces_along_its_rotated_axis(geometry, angle):
    floor = wall("floor", (0, -0.1), (2, 0), f"rotate = {angle}\npivot = [0, 0]")
    x, n, depth = geometry(
        "floor", WATER.replace("min", f"rotate = {angle}\npivot = [0, 0]\nmin") + floor
    )
    turned = np.radians(angle)
    normal = np.array([-np.sin(turned), np.cos(turned)])
    np.testing.assert_allclose(n, np.broadcast_to(normal, x.shape), atol=1e-12)
    np.testing.assert_allclose(depth, -(x @ normal), atol=1e-12)


def test_a_rotated_block_faces_along_its_own_sides(geometry):
    rotation = "rotate = 25\npivot = [3, 0]"
    x, n, depth = geometry("block", WATER + wall("block", (3, 0), (5, 1), rotation))
    turned = np.radians(25)
    along, up = (
        np.array([np.cos(turned), np.sin(turned)]),
        np.array([-np.sin(turned), np.cos(turned)]),
    )
    own = np.stack([(x - [3, 0]) @ along, (x - [3, 0]) @ up])
    gaps = np.stack([own[0], 2 - own[0], own[1], 1 - own[1]])
    np.testing.assert_allclose(depth, gaps.min(axis=0), atol=1e-12)
    nearest = np.isclose(gaps, depth)
    faces = np.stack([-along, along, -up, up])
    expected = nearest.T @ faces / np.sqrt(nearest.sum(axis=0))[:, None]
    np.testing.assert_allclose(n, expected, atol=1e-12)


def test_a_given_normal_counts(geometry):
    """Its length does not, and the surface lies half a spacing beyond the foremost particles."""
    x, n, depth = geometry("block", WATER + wall("block", (3, 0), (5, 1), "normal = [0, -3]"))
    np.testing.assert_allclose(n, np.broadcast_to([0, -1], x.shape))
    np.testing.assert_allclose(depth, x[:, 1], atol=1e-12)


def test_a_given_normal_turns_with_its_body(geometry):
    """By its own `rotate`, and as a turned copy."""
    keys = "normal = [0, -3]\nrotate = 25\npivot = [3, 0]"
    down = np.array([np.sin(np.radians(25)), -np.cos(np.radians(25))])
    x, n, depth = geometry("block", WATER + wall("block", (3, 0), (5, 1), keys))
    np.testing.assert_allclose(n, np.broadcast_to(down, x.shape), atol=1e-12)
    np.testing.assert_allclose(depth, -((x - [3, 0]) @ down), atol=1e-12)
    keys = keys.replace("25", "15") + "\narray = { turns = 2, about = [3, 0], angle = 10 }"
    y, m, below = geometry("block.2", WATER + wall("block", (3, 0), (5, 1), keys))
    for one, other in ((x, y), (n, m), (depth, below)):
        np.testing.assert_allclose(one, other, atol=1e-12)


@pytest.mark.parametrize("rotate", ["", "rotate = 30\npivot = [3, 0]"])
def test_a_normal_of_no_face_is_refused(geometry, rotate):
    """As one that was turned by hand is, beside `rotate`."""
    keys = f"normal = [-0.5, 0.866]\n{rotate}"
    with pytest.raises(UserError, match=r"body.block.*\[-0.5, 0.866\] is no normal of a face"):
        geometry("block", WATER + wall("block", (3, 0), (5, 1), keys))


def test_a_row_faces_the_flow_that_enters(geometry):
    """Before anything has entered there is no water to face."""
    inflow = """
[inflow.i]
material = "water"
rate = 0.3
width = 1
position = [2, 0]
direction = [-1, 0]
depth = 0.4
duration = 1
"""
    _, n, _ = geometry("floor", wall("floor", (0, -0.1), (2, 0)) + inflow)
    assert (n == [0, 1]).all()


def test_walls_in_3d(write):
    """A row turned about y."""
    tables = """
[body.water]
shape = "box"
material = "water"
min = [0, 0, 0.5]
max = [1, 1, 1]

[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [0, 0, -0.1]
max = [1, 1, 0]
rotate = 20
rotate_axis = [0, 1, 0]
pivot = [0, 0, 0]
"""
    path = write(top=FAST, tables=tables)
    scenario = load_scenario(path, ["dim=3"])
    particles, names = build_bodies(scenario)
    normal, depth, _ = wall_geometry(scenario, particles, names)
    floor = particles.body == names.index("floor")
    up = np.array([np.sin(np.radians(20)), 0, np.cos(np.radians(20))])
    np.testing.assert_allclose(normal[floor], np.broadcast_to(up, (floor.sum(), 3)), atol=1e-12)
    np.testing.assert_allclose(depth[floor], -(particles.position[floor] @ up), atol=1e-12)


def test_carved_from_a_box(geometry):
    """The surface is where `where` vanishes: here a slope of 3 in 4 and a wave."""
    slope = 'where = "= 1 - 0.75*x - y"'
    position, normal, depth = geometry("bed", WATER + wall("bed", [0, -1], [1, 1], slope))
    np.testing.assert_allclose(normal, np.tile([0.6, 0.8], (len(normal), 1)), atol=1e-6)
    expected = (1 - 0.75 * position[:, 0] - position[:, 1]) / 1.25
    np.testing.assert_allclose(depth, expected, atol=1e-9)
    wave = 'where = "= 0.1*sin(3*x) - y"'
    position, normal, _ = geometry("bed", WATER + wall("bed", [0, -1], [1, 1], wave))
    tilt = -0.3 * np.cos(3 * position[:, 0])
    np.testing.assert_allclose(normal[:, 0] / normal[:, 1], tilt, atol=1e-5)
