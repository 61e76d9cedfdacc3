"""Where balls touch meshes that are not convex, in 2-D and 3-D."""

import numpy as np
import pytest
import trimesh

# A block with a groove of 90 degrees in its top, outside to the right of each segment.
GROOVE = [(-2, 2), (0, 0), (2, 2), (2, -2), (-2, -2)]
SEGMENTS = [GROOVE[(k + 1 - n) % 5] for k in range(5) for n in (0, 1)]


def places(row, dim):
    """Distances (n,) and normals (n, dim) of one answer."""
    table = np.array(row).reshape(-1, 1 + dim)
    return table[:, 0], table[:, 1:]


@pytest.mark.parametrize(
    ("point", "distance", "normal"),
    [
        ([0, 1], np.sqrt(0.5), None),  # as near to both sides
        ([1, 2], np.sqrt(0.5), [-np.sqrt(0.5), np.sqrt(0.5)]),
        ([0, -0.5], -0.5, [0, 1]),  # below the bottom of the groove: its corner is nearest
        ([-1.5, 0], -0.5, [-1, 0]),
        ([0, -3], 1, [0, -1]),
        ([3, 3], np.sqrt(2), [np.sqrt(0.5), np.sqrt(0.5)]),
    ],
)
def test_distance_from_a_polygon_that_is_not_convex(physics, point, distance, normal):
    (row,) = physics.two.mesh_from(SEGMENTS, 0.0, [point])
    assert row[0] == pytest.approx(distance)
    if normal is not None:
        assert row[1:] == pytest.approx(normal)


@pytest.mark.parametrize(
    ("point", "radius", "count"),
    [
        ([0, 1], 0.72, 2),
        ([0.01, 1], 0.703, 1),
        ([0, 1], 0.7, 0),
        ([0, -3], 1.1, 1),
        ([2.3, 2.3], 0.5, 1),
    ],
)
def test_a_disc_touches_each_side_of_a_groove_once(physics, point, radius, count):
    (row,) = physics.two.mesh_touched(SEGMENTS, 0.0, [point], radius)
    distance, normal = places(row, 2)
    assert len(distance) == count
    if count == 2:
        assert sorted(normal[:, 0]) == pytest.approx([-np.sqrt(0.5), np.sqrt(0.5)])
        assert distance == pytest.approx(np.sqrt(0.5))


def test_distance_from_a_torus(physics):
    """Against its closed form, to the height of its facets' arcs."""
    torus = trimesh.creation.torus(1.0, 0.4, major_sections=64, minor_sections=32)
    points = np.random.default_rng(5).uniform(-1.6, 1.6, (300, 3))
    rows = physics.three.mesh_from(torus.triangles.reshape(-1, 3).tolist(), 0.0, points.tolist())
    ring = np.hypot(points[:, 0], points[:, 1]) - 1
    exact = np.hypot(ring, points[:, 2]) - 0.4
    found = np.array(rows)
    assert found[:, 0] == pytest.approx(exact, abs=0.005)
    assert np.linalg.norm(found[:, 1:], axis=1) == pytest.approx(1)


@pytest.mark.parametrize("level", [0, 2, 3])
def test_a_ball_in_a_corner_touches_its_three_sides_however_finely_they_are_cut(physics, level):
    room = trimesh.creation.box(bounds=[[0, 0, 0], [4, 4, 4]])
    for _ in range(level):
        room = room.subdivide()
    room.invert()  # what is outside is the room
    corners = room.triangles.reshape(-1, 3).tolist()
    (row,) = physics.three.mesh_touched(corners, 0.0, [[0.97, 0.98, 0.99]], 1.0)
    distance, normal = places(row, 3)
    assert distance == pytest.approx([0.97, 0.98, 0.99])
    assert normal == pytest.approx(np.eye(3))


def test_a_sheet_is_touched_from_both_sides(physics):
    plane = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    above, below, inside, beside = physics.three.mesh_from(
        plane, 0.2, [[0.1, 0, 0.5], [0.1, 0, -0.5], [0.1, 0, 0.05], [1.5, 0, 0]]
    )
    assert above == pytest.approx([0.4, 0, 0, 1])
    assert below == pytest.approx([0.4, 0, 0, -1])
    assert inside == pytest.approx([-0.05, 0, 0, 1])
    assert beside == pytest.approx([0.4, 1, 0, 0])
