"""Bodies that touch fixed meshes: hollows, flat faces of many triangles, edges, sheets."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from doseki.compiled import load_core
from doseki.errors import UserError

from ..flows import Flows

G = 9.81
HEAD = """\
dim = 3
scheme = "resolved"
speed_max = 2
dp = 0.05
time_max = 10
time_out = 10
gravity = {gravity}

[contact]
law = "{law}"
overlap = 0.005
speed = 1

[material.rock]
law = "solid"
rho0 = 2500
young_modulus = 1e9
poisson_ratio = 0.25
restitution = {restitution}
friction = {friction}
rolling_friction = 0
"""
BALL = """
[body.ball]
shape = "sphere"
material = "rock"
radius = 0.1
centre = {centre}
velocity = {velocity}
spin = {spin}
"""
BLOCK = """
[body.block]
shape = "box"
material = "rock"
min = {min}
max = {max}
"""
BED = """
[body.bed]
shape = "mesh"
material = "rock"
file = "bed.{kind}"
{more}
"""
BOX = """
[body.bed]
shape = "box"
material = "rock"
fixed = true
min = [-1, -0.5, -0.5]
max = [1, 0.5, 0]
"""


def head(**values: Any) -> str:
    return HEAD.format(
        **{"gravity": [0, 0, -G], "law": "hertz", "restitution": 0.5, "friction": 0.5} | values
    )


def ball(centre: Any, velocity: Any = (0, 0, 0), spin: Any = (0, 0, 0)) -> str:
    lists = [np.asarray(v, float).tolist() for v in (centre, velocity, spin)]
    return BALL.format(centre=lists[0], velocity=lists[1], spin=lists[2])


def bed(folder: Path, mesh: trimesh.Trimesh, more: str = "", kind: str = "ply") -> str:
    """In double precision, as PLY keeps it."""
    encoding = {"ply": {"vertex_normal": False}}.get(kind, {})
    mesh.export(folder / f"bed.{kind}", **encoding)
    return BED.format(kind=kind, more=more)


def to(simulation: Any, time: float) -> Any:
    simulation.advance(limit=time, pause=time, max_steps=10**9)
    return simulation


def mover(simulation: Any) -> dict[str, np.ndarray]:
    """The one body that moves."""
    grains = simulation.grains()
    (k,) = np.flatnonzero(~np.asarray(grains["fixed"]))
    return {key: np.asarray(v)[k] for key, v in grains.items() if np.ndim(v)}


def prism(profile: list[tuple[float, float]], depth: float = 1.0) -> trimesh.Trimesh:
    """A closed body with this outline in x and z, clockwise, cut into as many slices along y as
    there are corners.
    """
    n, ring = len(profile), np.array(profile)
    rows = [np.insert(ring, 1, y, axis=1) for y in (-depth / 2, depth / 2)]
    vertices = np.concatenate(rows)
    faces = []
    for k in range(n):
        a, b = k, (k + 1) % n
        faces += [[a, b, n + b], [a, n + b, n + a]]
    triangles = _ears(ring)
    faces += [list(t) for t in triangles] + [[n + t[0], n + t[2], n + t[1]] for t in triangles]
    return trimesh.Trimesh(vertices, faces, process=False)


def _ears(ring: np.ndarray) -> list[tuple[int, int, int]]:
    """Triangles of a polygon, each cut off where nothing else lies in it."""
    left, found = list(range(len(ring))), []

    def turn(a: int, b: int, c: int) -> float:
        u, v = ring[b] - ring[a], ring[c] - ring[b]
        return float(u[0] * v[1] - u[1] * v[0])

    sign = np.sign(sum(turn(0, k, k + 1) for k in range(1, len(ring) - 1)))
    while len(left) > 3:
        for k, b in enumerate(left):
            a, c = left[k - 1], left[(k + 1) % len(left)]
            others = [p for p in left if p not in (a, b, c)]
            hit = any(
                all(sign * turn(*pair, p) >= 0 for pair in ((a, b), (b, c), (c, a))) for p in others
            )
            if sign * turn(a, b, c) > 0 and not hit:
                found.append((a, b, c))
                left.pop(k)
                break
    return [*found, (left[0], left[1], left[2])]


def groove(left: float, right: float) -> trimesh.Trimesh:
    """A block with a V along y whose sides rise by these angles, degrees."""
    a, b = np.tan(np.radians([left, right]))
    low = -0.5
    return prism([(-0.5, low), (-0.5, 0.5 * a), (0, 0), (0.5, 0.5 * b), (0.5, low)])


@pytest.mark.parametrize(("left", "right"), [(45, 45), (30, 60), (60, 60), (15, 15), (10, 75)])
def test_a_ball_in_a_groove_is_held_by_both_sides(tmp_path, left, right):
    """Without friction N = m g sin(other side)/sin(left + right), by Hertz of the overlaps."""
    bottom = 0.1 / np.sin(0.5 * np.radians(180 - left - right))
    away = np.radians(90 + 0.5 * (left - right))
    start = bottom * np.array([-np.cos(away), 0, np.sin(away)])
    text = head(friction=0, restitution=0.2) + ball(start + np.array([0, 0, 1e-4]))
    simulation = Flows(tmp_path)(text + bed(tmp_path, groove(left, right)))
    state = mover(to(simulation, 0.6))
    assert np.linalg.norm(state["velocity"]) < 1e-3
    weight = state["mass"] * G
    assert state["contact_force"] == pytest.approx([0, 0, weight], abs=2e-3 * weight)
    angles = np.radians([left, right])
    normals = np.array(
        [[np.sin(angles[0]), 0, np.cos(angles[0])], [-np.sin(angles[1]), 0, np.cos(angles[1])]]
    )
    overlap = 0.1 - normals @ state["centre"]
    exact = weight * np.sin(angles[::-1]) / np.sin(angles.sum())
    assert (overlap[0] / overlap[1]) ** 1.5 == pytest.approx(exact[0] / exact[1], rel=0.01)
    assert state["contacts"] == 2


def many_triangles(folder: Path, **more: Any) -> str:
    """The bed's box with a top of 1600 triangles of all kinds of sizes."""
    mesh = trimesh.creation.box(bounds=[[-1, -0.5, -0.5], [1, 0.5, 0]])
    for _ in range(3):
        mesh = mesh.subdivide()
    random = np.random.default_rng(2)
    v = mesh.vertices.copy()
    inner = np.isclose(v[:, 2], 0) & (np.abs(v[:, 0]) < 0.99) & (np.abs(v[:, 1]) < 0.49)
    v[inner, :2] += random.uniform(-0.02, 0.02, (inner.sum(), 2))
    return bed(folder, trimesh.Trimesh(v, mesh.faces, process=False), **more)


def rolling(folder: Path, text: str, gravity: Any = (0, 0, -G)) -> dict[str, np.ndarray]:
    speed = 1.0
    moving = ball([-0.7, 0.03, 0.1], [speed, 0.1, 0], [-0.1 / 0.1, speed / 0.1, 0])
    folder.mkdir(exist_ok=True)
    simulation = Flows(folder)(head(gravity=list(gravity), restitution=0.9) + moving + text)
    return mover(to(simulation, 1.2))


@pytest.mark.parametrize("kind", ["ply", "stl"])
def test_a_ball_that_rolls_does_not_feel_the_edges_of_triangles(tmp_path, kind):
    on_box = rolling(tmp_path / "box", BOX)
    (tmp_path / "mesh").mkdir()
    on_mesh = rolling(tmp_path / "mesh", many_triangles(tmp_path / "mesh", kind=kind))
    within = 1e-9 if kind == "ply" else 1e-5  # an STL holds single precision
    for key in ("centre", "velocity", "spin"):
        assert on_mesh[key] == pytest.approx(on_box[key], abs=within), key
    energy = 0.5 * on_mesh["velocity"] @ on_mesh["velocity"] * 1.4
    assert energy == pytest.approx(0.5 * 1.4 * 1.01, rel=1e-3)


@pytest.mark.parametrize("slope", [10, 50])
def test_a_ball_rolls_or_slides_down_a_mesh_as_down_a_box(tmp_path, slope):
    """a = 5/7 g sin, or g (sin - mu cos) where friction 0.5 does not hold it."""
    t = np.radians(slope)
    gravity = [float(G * np.sin(t)), 0, float(-G * np.cos(t))]
    found = {}
    for name in ("box", "mesh"):
        (tmp_path / name).mkdir()
        text = BOX if name == "box" else many_triangles(tmp_path / name)
        moving = ball([-0.8, 0, 0.1])
        simulation = Flows(tmp_path / name)(head(gravity=gravity) + moving + text)
        found[name] = mover(to(simulation, 0.4))
    rolls = 5 / 7 * G * np.sin(t)
    slides = G * (np.sin(t) - 0.5 * np.cos(t))
    exact = max(rolls, slides) * 0.4
    assert found["mesh"]["velocity"][0] == pytest.approx(exact, rel=0.02)
    assert found["mesh"]["velocity"] == pytest.approx(found["box"]["velocity"], abs=1e-3 * exact)


def ridge(top: float = 0.0) -> trimesh.Trimesh:
    """A narrow sill along y."""
    return prism([(-0.02, -0.4), (-0.02, top), (0.02, top), (0.02, -0.4)], depth=0.12)


def block_on_sills(folder: Path, sills: list[trimesh.Trimesh]) -> Any:
    moving = BLOCK.format(min=[-0.3, -0.1, 0.0005], max=[0.3, 0.1, 0.2005])
    text = head(restitution=0.2) + moving + bed(folder, trimesh.util.concatenate(sills))
    return Flows(folder)(text)


def test_a_block_lies_on_sills_that_its_corners_do_not_see(tmp_path):
    sills = [ridge().apply_translation([x, 0, 0]) for x in (-0.2, 0.2)]
    state = mover(to(block_on_sills(tmp_path, sills), 0.5))
    assert state["centre"] == pytest.approx([0, 0, 0.1], abs=1e-3)
    assert state["contact_force"][2] == pytest.approx(state["mass"] * G, rel=1e-3)
    assert np.abs(state["spin"]).max() < 0.01


def test_without_points_on_edges_it_would_fall_through(tmp_path, monkeypatch):
    from doseki.scene.shapes import MeshShape

    monkeypatch.setattr(MeshShape, "samples", lambda self, dp: np.zeros((0, 3)))
    sills = [ridge().apply_translation([x, 0, 0]) for x in (-0.2, 0.2)]
    state = mover(to(block_on_sills(tmp_path, sills), 0.3))
    assert state["centre"][2] < 0.0


def test_a_block_stands_on_a_mesh_as_on_a_box(tmp_path):
    moving = BLOCK.format(min=[-0.1, -0.1, 0.0005], max=[0.1, 0.1, 0.2005])
    heights = []
    for name in ("box", "mesh"):
        (tmp_path / name).mkdir()
        text = BOX if name == "box" else many_triangles(tmp_path / name)
        simulation = Flows(tmp_path / name)(head(restitution=0.2) + moving + text)
        state = mover(to(simulation, 0.3))
        assert state["contact_force"][2] == pytest.approx(state["mass"] * G, rel=1e-3)
        heights.append(state["centre"][2])
    assert heights[1] == pytest.approx(heights[0], abs=1e-5)


def sheet(bent: float = 0.0) -> trimesh.Trimesh:
    """A plane of 1 m, or a roof that falls by `bent` on either side."""
    x = np.array([-0.5, 0, 0.5])
    v = np.array([[a, b, -abs(a) * bent] for a in x for b in (-0.5, 0.5)])
    return trimesh.Trimesh(v, [[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]], process=False)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("flipped", [False, True])
def test_a_sheet_holds_a_ball_on_either_side(tmp_path, side, flipped):
    mesh = sheet()
    if flipped:
        mesh.invert()
    text = head(gravity=[0, 0, -G * side], restitution=0.2) + ball([0.1, 0, side * 0.1305])
    simulation = Flows(tmp_path)(text + bed(tmp_path, mesh, more="sheet = true\nthickness = 0.06"))
    state = mover(to(simulation, 0.3))
    assert state["centre"][2] == pytest.approx(side * 0.13, abs=2e-4)
    assert state["contact_force"][2] == pytest.approx(side * state["mass"] * G, rel=1e-3)


def test_a_block_lies_on_the_rim_of_a_sheet(tmp_path):
    up = [sheet().apply_transform(_upright(x)) for x in (-0.2, 0.2)]
    mesh = trimesh.util.concatenate(up)
    moving = BLOCK.format(min=[-0.3, -0.1, 0.0305], max=[0.3, 0.1, 0.2305])
    text = head(restitution=0.2) + moving
    simulation = Flows(tmp_path)(text + bed(tmp_path, mesh, more="sheet = true\nthickness = 0.06"))
    state = mover(to(simulation, 0.4))
    assert state["centre"] == pytest.approx([0, 0, 0.13], abs=1e-3)


def _upright(x: float) -> np.ndarray:
    """The plane stands at x, with its rim at z = 0."""
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, [0, 1, 0])
    turn[:3, 3] = [x, 0, -0.5]
    return turn


def test_a_ball_that_goes_on_from_a_checkpoint_has_the_same_bits(tmp_path):
    moving = ball([0, 0, 0.16], [0, 0.3, 0])
    text = head(restitution=0.2) + moving + bed(tmp_path, groove(40, 50))
    simulation = Flows(tmp_path)(text)
    saved = to(simulation, 0.45).checkpoint()
    assert (np.abs(saved["contact_springs"]).max(axis=1) > 0).sum() == 2, "it touches both sides"
    other = Flows(tmp_path).empty(text)
    assert other.restore(saved)
    one, two = to(simulation, 0.6).grains(), to(other, 0.6).grains()
    for key in one:
        assert np.array_equal(one[key], two[key]), key


def test_threads_do_not_change_a_bit(tmp_path):
    """Eighty balls that fall on a bed of 1600 triangles, many at several places."""
    packing = """
[body.balls]
shape = "sphere"
material = "rock"
d = 0.12
min = [-0.45, -0.45, 0.02]
max = [0.45, 0.45, 0.5]
count = 80
"""
    text = head(restitution=0.3) + packing + bed(tmp_path, bumpy())
    core, found = load_core(), []
    for threads in (1, 2):
        core.set_threads(threads)
        found.append(to(Flows(tmp_path)(text), 0.12).grains())
    assert (found[0]["contacts"] > 1).any()
    for key in found[0]:
        assert np.array_equal(found[0][key], found[1][key]), key


def bumpy() -> trimesh.Trimesh:
    """A block with hollows and humps of 0.02 m on its top."""
    mesh = trimesh.creation.box(bounds=[[-0.6, -0.6, -0.3], [0.6, 0.6, 0]])
    for _ in range(4):
        mesh = mesh.subdivide()
    v = mesh.vertices.copy()
    top = np.isclose(v[:, 2], 0)
    v[top, 2] -= 0.01 + 0.01 * (np.cos(30 * v[top, 0]) * np.cos(30 * v[top, 1]))
    return trimesh.Trimesh(v, mesh.faces, process=False)


@pytest.mark.parametrize("what", ["ball", "block"])
def test_what_starts_inside_a_mesh_is_refused(tmp_path, what):
    inside = {
        "ball": ball([0.1, 0, 0.09]),
        "block": BLOCK.format(min=[-0.1, -0.1, -0.01], max=[0.1, 0.1, 0.2]),
    }
    with pytest.raises(UserError, match=rf"body\.{what}: a body of it overlaps bed by 0\.01 m"):
        Flows(tmp_path)(head() + inside[what] + many_triangles(tmp_path))
