"""Faces of fixed bodies that others cover are none for the particles near them."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.scene.shapes import PlaneFaces, box_shape, polygon_shape
from doseki.scene.walls.normals import wall_geometry

TOP = 'scheme = "resolved"\nspeed_max = 2'
FIXED = '\n[body.{name}]\nmaterial = "basalt"\nfixed = true\n{keys}\n'
WATER = '\n[body.water]\nshape = "box"\nmaterial = "water"\nmin = {low}\nmax = {high}\n'
LEFT, RIGHT = [(0, -1), (2, -1), (2, 0), (0, 0)], [(2, -1), (4, -1), (4, 0), (2, 0)]


def rotation(degrees):
    angle = np.radians(degrees)
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def polygon(name, corners, turn=0, more=""):
    placed = (np.array(corners, float) @ rotation(turn).T).tolist()
    return FIXED.format(name=name, keys=f'shape = "polygon"\nvertices = {placed}\n{more}')


def box(name, low, high, turn=0, more=""):
    rotate = f"rotate = {turn}\npivot = {[0] * len(low)}\n" if turn else ""
    keys = f'shape = "box"\nmin = {list(low)}\nmax = {list(high)}\n{rotate}{more}'
    return FIXED.format(name=name, keys=keys)


def rectangle(corners):
    return corners[0], corners[2]


class Walls:
    """The walls of a scene, in a frame turned by so many degrees."""

    def __init__(self, write, tables, turn=0, settings=(), top=TOP):
        dim = 3 if "dim=3" in settings else 2
        water = WATER.format(low=[1] + [-9] * (dim - 1), high=[1.5] + [-8.5] * (dim - 1))
        scenario = load_scenario(write(top=top, tables=tables + water), list(settings))
        self.scene = build_scene(scenario)
        found = wall_geometry(scenario, self.scene.particles, self.scene.names, self.scene.bodies)
        back = rotation(turn) if dim == 2 else np.eye(3)
        self.position = self.scene.particles.position @ back
        self.edges = found.edges
        self.normal, self.depth = found.normal @ back, found.depth
        near = found.edges.depths < scenario.support  # the others fluid is never in front of
        self.beside = np.where(near[..., None], found.edges.normals @ back, 0)

    def of(self, name, near, reach):
        """Mask of the particles of a body within so many m of a place."""
        mine = self.scene.particles.body == self.scene.names.index(name)
        return mine & (np.abs(self.position - np.array(near, float)) < reach).all(axis=1)

    def faces_up(self, name, near=(2, 0), reach=0.4):
        """Whether the particles of a body beside a joint have the upper side and no other."""
        mine = self.of(name, near, reach)
        assert mine.sum() >= 4
        up = np.eye(len(near))[-1]
        return (
            np.allclose(self.normal[mine], up)
            and np.allclose(self.depth[mine], -self.position[mine] @ up)
            and np.allclose(self.beside[mine][..., :-1], 0)
        )


PAIRS = {
    "polygons": lambda turn: polygon("a", LEFT, turn) + polygon("b", RIGHT, turn),
    "boxes": lambda turn: box("a", *rectangle(LEFT), turn) + box("b", *rectangle(RIGHT), turn),
    "box and polygon": lambda turn: box("a", *rectangle(LEFT), turn) + polygon("b", RIGHT, turn),
    "polygon and box": lambda turn: polygon("a", LEFT, turn) + box("b", *rectangle(RIGHT), turn),
    "thick polygon": lambda turn: (
        polygon("a", [(0, -3), (2, -3), (2, 0), (0, 0)], turn) + polygon("b", RIGHT, turn)
    ),
    "thick box": lambda turn: box("a", (0, -3), (2, 0), turn) + box("b", *rectangle(RIGHT), turn),
    "slab": lambda turn: polygon("a", LEFT, turn) + box("b", (2, -0.4), (4, 0), turn, UP),
}
UP = "normal = [0, 1]"


@pytest.mark.parametrize("turn", [0, 30])
@pytest.mark.parametrize("pair", PAIRS)
def test_a_joint_in_one_plane_has_no_faces(write, pair, turn):
    walls = Walls(write, PAIRS[pair](turn), turn)
    assert walls.faces_up("a", reach=0.2)
    assert walls.faces_up("b", reach=0.2)


def test_copies_in_a_row_have_no_faces_between_them(write):
    row = polygon("a", LEFT, more="array = { count = [2, 1], step = [2, 0] }")
    assert Walls(write, row).faces_up("a.1")
    assert Walls(write, row).faces_up("a.2")


@pytest.mark.parametrize("rise", [-0.6, -0.2, 0.2, 0.6])
def test_a_kink_has_the_face_of_each_side(write, rise):
    ramp = [(2, -1), (4, -1 + 2 * rise), (4, 2 * rise), (2, 0)]
    walls = Walls(write, polygon("a", LEFT) + polygon("b", ramp))
    assert walls.faces_up("a", reach=0.3)
    mine = walls.of("b", (2, 0), 0.3)
    assert mine.sum() >= 4
    up = np.array([-rise, 1]) / np.hypot(rise, 1)
    np.testing.assert_allclose(walls.normal[mine], np.broadcast_to(up, (mine.sum(), 2)), atol=1e-9)


@pytest.mark.parametrize("kind", [box, polygon])
def test_what_is_not_covered_of_a_side_is_a_face(write, kind):
    """A thick body beside a thin one: below the thin one its side is free."""
    corners = [(0, -3), (2, -3), (2, 0), (0, 0)]
    thick = box("a", *rectangle(corners)) if kind is box else polygon("a", corners)
    walls = Walls(write, thick + polygon("b", RIGHT))
    mine = walls.of("a", (2, -2), 0.3)
    np.testing.assert_allclose(walls.normal[mine], np.broadcast_to([1, 0], (mine.sum(), 2)))
    np.testing.assert_allclose(walls.depth[mine], 2 - walls.position[mine][:, 0])
    assert walls.faces_up("a")


def test_the_floor_before_a_wall_that_stands_on_it_faces_up(write):
    floor = polygon("floor", [(0, -1), (4, -1), (4, 0), (0, 0)])
    walls = Walls(write, floor + polygon("wall", [(2, 0), (3, 0), (3, 2), (2, 2)]))
    assert walls.faces_up("floor", reach=0.2)
    foot = walls.of("wall", (2, 0.2), 0.2)
    np.testing.assert_allclose(walls.normal[foot], np.broadcast_to([-1, 0], (foot.sum(), 2)))


OTHERS = {
    "cut": box("b", (2, -1), (4, 1), more='where = "= -y"'),
    "disc": FIXED.format(name="b", keys='shape = "disc"\ncentre = [3, -0.5]\nradius = 1.05'),
    "points": FIXED.format(
        name="b",
        keys='shape = "points"\nmass = 1\nnormal = [0, 1]\nposition = '
        + str([[2.05 + 0.1 * i, -0.05 - 0.1 * k] for i in range(5) for k in range(10)]),
    ),
}


@pytest.mark.parametrize("kind", OTHERS)
def test_walls_of_any_kind_cover(write, kind):
    walls = Walls(write, polygon("a", LEFT) + OTHERS[kind])
    middle = walls.of("a", (2, -0.5), 0.25)
    assert (walls.normal[middle][:, 0] < 0.8).all()
    assert walls.beside[middle][..., 0].max() < 0.8


GOES = "[body.{}.motion]\nvelocity = [0, {}]\n"


def test_what_moves_covers_nothing_but_what_moves_alike(write):
    def joint(a, b):
        tables = polygon("a", LEFT, more=a) + polygon("b", RIGHT, more=b)
        walls = Walls(write, tables)
        return walls.faces_up("a"), walls.faces_up("b")

    assert joint("", GOES.format("b", 1)) == (False, False)
    assert joint(GOES.format("a", 1), GOES.format("b", 2)) == (False, False)
    assert joint(GOES.format("a", 1), GOES.format("b", 1)) == (True, True)


@pytest.mark.parametrize("gap", [0.06, 0.2])
def test_bodies_that_stand_apart_are_as_each_is_alone(write, gap):
    """To the last digit."""
    right = [(x + gap, y) for x, y in RIGHT]
    walls = Walls(write, polygon("a", LEFT) + polygon("b", right))
    shaped = walls.scene.bodies.shaped
    assert (walls.normal[shaped] == walls.scene.bodies.normal[shaped]).all()
    assert (walls.depth[shaped] == walls.scene.bodies.depth[shaped]).all()
    assert (walls.edges.normals[shaped] == walls.scene.bodies.edge_normals[shaped]).all()
    assert not walls.faces_up("a")


def test_a_body_meets_its_own_image(write):
    domain = 'periodic = ["x"]\ndomain_min = [0, -20]\ndomain_max = [4, 9]'
    bed = polygon("a", [(0, -1), (4, -1), (4, 0), (0, 0)])
    walls = Walls(write, bed, top=f"{TOP}\n{domain}")
    assert walls.faces_up("a", (0, 0))
    assert walls.faces_up("a", (4, 0))


@pytest.mark.parametrize("kinds", ["stl stl", "box stl", "stl box"])
def test_a_joint_in_space(write, tmp_path, kinds):
    import trimesh

    tables = ""
    for name, kind, x in zip("ab", kinds.split(), (0, 2), strict=True):
        low, high = (x, 0, -1), (x + 2, 1, 0)
        if kind == "box":
            tables += box(name, low, high)
            continue
        trimesh.creation.box(bounds=[low, high]).export(tmp_path / f"{name}.stl")
        tables += FIXED.format(name=name, keys=f'shape = "stl"\nfile = "{name}.stl"')
    walls = Walls(write, tables, settings=["dim=3"])
    assert walls.faces_up("a", (2, 0.5, 0), 0.25)
    assert walls.faces_up("b", (2, 0.5, 0), 0.25)


def test_feet_lie_on_their_sides():
    """Above each point where the side is, on its rim elsewhere."""
    wedge, place = polygon_shape(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0]]))
    faces = PlaneFaces.of(wedge, place, np.eye(2))
    point = np.array([[3.9, 0.02], [1.0, 0.1]]) - faces.place
    feet = faces.feet(point, np.arange(3)) + faces.place
    slope = int(np.argmax(faces.normals[:, 1]))
    np.testing.assert_allclose(feet[0, slope, 1], 0.25 * feet[0, slope, 0])
    foot = int(np.argmin(faces.normals[:, 1]))
    np.testing.assert_allclose(feet[:, foot], [[3.9, 0], [1.0, 0]], atol=1e-12)
    cube = PlaneFaces.of(box_shape(np.ones(3)), np.zeros(3), np.eye(3))
    assert (cube.high - cube.low).sum(axis=1) == pytest.approx(np.full(6, 2.0))
    outside = cube.feet(np.array([[0.2, 0.9, 0.1]]), np.arange(6))[0]
    assert np.abs(outside).max() == pytest.approx(0.5)
