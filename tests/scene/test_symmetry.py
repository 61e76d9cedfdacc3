"""What shapes give has no preferred direction: it has their symmetries and turns with them."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.scene.shapes import (
    Ball,
    Convex,
    Particles,
    Shape,
    box_shape,
    mesh_shape,
    polygon_shape,
)

DP = 1 / 6
SINGLE = 1e-6  # what single precision, in which STL files hold numbers, leaves of lengths of 1


def moves_of_the_cube(dim: int) -> list[np.ndarray]:
    """The 8 symmetries of the square, or the 48 of the cube."""
    signs = list(product((1.0, -1.0), repeat=dim))
    axes = permutations(range(dim))
    return [np.eye(dim)[list(order)] * sign for order in axes for sign in signs]


def moves_of_a_polygon(n: int) -> list[np.ndarray]:
    """The 2 n symmetries of a regular polygon with a corner on the x axis."""
    angles = 2 * np.pi * np.arange(n) / n
    turns = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in angles]
    return [turn * flip for turn in turns for flip in ((1, 1), (1, -1))]


def assert_mapped(points, move, image=None, tolerance=1e-12):
    """Points with columns (N, ...), moved, are those of `image`, or their own, in any order.

    The first column are places; further ones of vectors are moved as well.
    """
    moved = [column @ move.T if np.ndim(column) == 2 else column for column in columns(points)]
    target = columns(points if image is None else image)
    assert len(moved[0]) == len(target[0])
    distance, found = cKDTree(target[0]).query(moved[0])
    assert distance.max() < tolerance
    assert len(np.unique(found)) == len(found)
    for column, other in zip(moved[1:], target[1:], strict=True):
        np.testing.assert_allclose(column, other[found], atol=tolerance)


def columns(points):
    """Those of points; the faces beside edges, in whatever order, as vectors."""
    if not isinstance(points, Particles):
        return points
    *own, edges = points
    return [*own, edges.normals.sum(axis=1), (edges.depths[..., None] * edges.normals).sum(axis=1)]


def regular(n: int) -> Convex:
    angle = 2 * np.pi * np.arange(n) / n
    return polygon_shape(np.stack([np.cos(angle), np.sin(angle)], axis=1))[0]


def solid(folder, corners, move=None) -> Convex:
    """The convex body with these corners, moved, from an STL file."""
    import trimesh

    moved = np.asarray(corners, float) @ (np.eye(3) if move is None else move).T
    trimesh.convex.convex_hull(moved).export(folder / "a.stl")
    return mesh_shape(folder / "a.stl", 1.0)[0]


CUBE = list(product((-0.5, 0.5), repeat=3))
OCTAHEDRON = [*np.eye(3), *-np.eye(3)]
TETRAHEDRON = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]


@pytest.mark.parametrize("across", [1, 2, 5, 6])
@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kind", ["box", "ball"])
def test_boxes_and_balls_have_all_symmetries_of_the_cube(kind, dim, across):
    shape: Shape = box_shape(np.ones(dim)) if kind == "box" else Ball(0.5, dim)
    particles = shape.particles(1 / across)
    assert particles.share @ particles.position == pytest.approx(np.zeros(dim), abs=1e-14)
    for move in moves_of_the_cube(dim):
        assert_mapped(particles, move)
        if isinstance(shape, Convex):
            assert_mapped([shape.samples(1 / across)], move)


def test_a_cuboid_has_its_mirrors():
    shape = box_shape(np.array([1.0, 0.8, 1.5]))
    for signs in product((1, -1), repeat=3):
        assert_mapped(shape.particles(DP), np.diag(signs))
        assert_mapped([shape.samples(DP)], np.diag(signs))


@pytest.mark.parametrize(
    ("corners", "number"),
    [(CUBE, 48), (OCTAHEDRON, 48), (TETRAHEDRON, 24)],
    ids=["cube", "octahedron", "tetrahedron"],
)
def test_solids_from_files_have_their_symmetries(tmp_path, corners, number):
    """However their faces are cut into triangles."""
    shape = solid(tmp_path, corners)
    tree = cKDTree(shape.vertices)
    own = [m for m in moves_of_the_cube(3) if tree.query(shape.vertices @ m.T)[0].max() < SINGLE]
    assert len(own) == number
    for move in own:
        assert_mapped(shape.particles(DP), move, tolerance=SINGLE)
        assert_mapped([shape.samples(DP)], move, tolerance=SINGLE)


@pytest.mark.parametrize("n", [3, 4, 5, 6, 8])
def test_regular_polygons(n):
    """Points of contact and sides have all symmetries, particles those of their square lattice."""
    shape = regular(n)
    particles, moves = shape.particles(DP), moves_of_a_polygon(n)
    on_lattice = {
        tuple(np.round(shape.axes @ m @ shape.axes.T, 9).ravel()) for m in moves_of_the_cube(2)
    }
    shared = [move for move in moves if tuple(np.round(move, 9).ravel()) in on_lattice]
    assert len(shared) == {3: 2, 4: 8, 5: 2, 6: 4, 8: 8}[n]
    for move in moves:
        assert_mapped([shape.samples(DP)], move)
        assert_mapped([shape.outline.middles, shape.outline.normal], move)
    for move in shared:
        assert_mapped(particles, move)


@pytest.mark.parametrize("n", [3, 4, 6, 8, 16])
def test_faces_beside_an_edge_differ_by_fifty_degrees(n):
    """A particle below sides that lean less has the mean of them."""
    _, normal, _, _, _, edges = regular(n).particles(DP)
    first, second = edges.normals[:, 0], edges.normals[:, 1]
    beside = np.any(second != 0, axis=1)
    assert beside.any()
    assert (first * second).sum(axis=1)[beside].max() < np.cos(np.radians(50))
    if n >= 8:
        np.testing.assert_allclose(first[beside], normal[beside], atol=1e-12)


def test_the_part_of_a_lattice_that_a_slope_cuts_is_shared():
    """Half of each cell on the long side of a right triangle is inside."""
    shape, _ = polygon_shape(np.array([[0, 0], [1, 0], [0, 1.0]]))
    particles = shape.particles(0.1)
    assert len(particles.share) == 45 + 10
    inner, cut = particles.share.max(), particles.share.min()
    assert cut == pytest.approx(inner / 2)
    assert inner == pytest.approx(0.02)
    assert_mapped(particles, np.array([[0, 1.0], [1, 0]]))


def moves_of_space(dim: int) -> list[np.ndarray]:
    """A rotation about no axis of any lattice, and a mirror."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(dim, dim)))[0]
    return [turn, turn * ([-1.0] + [1.0] * (dim - 1))]


@pytest.mark.parametrize(
    "corners",
    [
        [[0, 0], [1.3, 0.1], [1.1, 0.9], [0.2, 1.2]],
        [[0, 0], [2, 0], [1.5, 1], [0.5, 1]],
        [[-1, -1], [1, -1], [1, 1], [-1, 1]],
    ],
    ids=["no symmetry", "trapezium", "square"],
)
def test_polygons_take_their_particles_along(corners):
    shape, _ = polygon_shape(np.array(corners, float))
    for move in moves_of_space(2):
        image, _ = polygon_shape(np.array(corners, float) @ move.T)
        assert_mapped(shape.particles(DP), move, image.particles(DP))
        assert_mapped([shape.samples(DP)], move, [image.samples(DP)])


@pytest.mark.parametrize(
    "corners",
    [CUBE, OCTAHEDRON, TETRAHEDRON, np.random.default_rng(1).normal(size=(40, 3))],
    ids=["cube", "octahedron", "tetrahedron", "boulder"],
)
def test_solids_take_their_particles_along(tmp_path, corners):
    shape = solid(tmp_path, corners)
    for move in moves_of_space(3):
        image = solid(tmp_path, corners, move)
        assert_mapped(shape.particles(DP), move, image.particles(DP), 10 * SINGLE)
        assert_mapped([shape.samples(DP)], move, [image.samples(DP)], 10 * SINGLE)


def test_opposite_sides_leave_no_normal():
    """A plate of one layer faces neither side."""
    particles = box_shape(np.array([1.0, 0.1])).particles(0.1)
    assert (particles.normal[1:-1] == 0).all()
    assert particles.depth == pytest.approx(np.full(10, 0.05))
