"""Bodies whose faces lie along no lattice of particles: their surface, and water at rest on it."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.driver.gauges import build_gauges
from doseki.scenario.gauges.loads.surface import surface_of
from doseki.solver.build import build_simulation
from doseki.solver.faces import cut, faces_of

from ..small_scenarios import BANKS
from .scenes import scenario_of

WEIGHT = 9810.0  # of a cubic metre of water, N
POOL = {
    2: """\
dim = 2
dp = 0.01
gravity = [0, -9.81]
body.tank = { shape = "tank", material = "aluminium", min = [0, 0], max = [0.8, 0.6] }
body.water = { shape = "box", material = "water", min = [0, 0], max = [0.8, 0.54] }
""",
    3: """\
dim = 3
dp = 0.02
gravity = [0, 0, -9.81]
body.tank = { shape = "tank", material = "aluminium", min = [0, 0, 0], max = [0.6, 0.6, 0.6] }
body.water = { shape = "box", material = "water", min = [0, 0, 0], max = [0.6, 0.6, 0.54] }
""",
}
REST = """\
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 4

[body.stone]
fixed = true
material = "basalt"
"""
GAUGE = '\n[gauge.stone]\nkind = "load"\nbodies = ["stone"]\n'
MIDDLE = np.array([0.3, 0.3, 0.27])


def pressed(folder, dim, stone):
    """Static force on the stone at the start, and the sum and the size of its surface."""
    scenario = scenario_of(folder, POOL[dim] + REST + stone + GAUGE)
    simulation, names = build_simulation(scenario)
    (reader,) = build_gauges(scenario, names)
    far = np.full(dim, np.inf)
    surface = surface_of(simulation, reader.setting, ["stone"], (-far, far)).area
    force = reader.gauge.static(simulation, reader.setting, (-far, far))[:dim]
    return force, surface.sum(axis=0), np.linalg.norm(surface, axis=1).sum()


def hull(points):
    """Triangles (n, 3, 3) around points, the volume within them and their area."""
    from scipy.spatial import ConvexHull

    made = ConvexHull(points)
    corners = points[made.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inwards = (normal * made.equations[:, :3]).sum(axis=1) < 0
    corners[inwards] = corners[inwards][:, ::-1]
    return corners, made.volume, made.area


def write_stl(path, corners):
    """A text STL of triangles (n, 3, 3)."""
    loops = (
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {!r} {!r} {!r}\n".format(*map(float, x)) for x in each)
        + "endloop\nendfacet\n"
        for each in corners
    )
    path.write_text("solid s\n" + "".join(loops) + "endsolid s\n")


def turned(axis, degrees):
    """A rotation about an axis."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(np.radians(degrees) * np.array(axis) / np.linalg.norm(axis))


def frustum(low, high):
    """Corners of a pyramid without its top: half its sides at the foot and at the top."""
    return np.array(
        [
            [x * r, y * r, z]
            for z, r in ((-0.12, low), (0.12, high))
            for x in (-1, 1)
            for y in (-1, 1)
        ]
    )


def ball():
    """Points spread over a sphere."""
    i = np.arange(300) + 0.5
    polar, around = np.arccos(1 - 2 * i / 300), np.pi * (1 + 5**0.5) * i
    ring = np.stack([np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar)], axis=1)
    return 0.14 * np.column_stack([ring, np.cos(polar)])


CUBE = frustum(0.12, 0.12)
WEDGE = np.array(
    [[x, y, z] for y in (-0.12, 0.12) for x, z in ((-0.18, -0.1), (0.18, -0.1), (0, 0.14))]
)
MESHES = {
    "ball": ball(),
    "frustum": frustum(0.18, 0.06),
    "frustum upside down": frustum(0.06, 0.18),
    "wedge": WEDGE,
    "cube turned by 45 degrees": turned([0, 0, 1], 45).apply(CUBE),
    "cube turned any way": turned([1, 2, 3], 35).apply(CUBE),
}


@pytest.mark.parametrize("shape", ["mesh", "stl"])
@pytest.mark.parametrize("name", MESHES)
def test_a_body_of_triangles_has_its_uplift(tmp_path, name, shape):
    """Its surface is closed to rounding, whatever the lattice of its particles."""
    corners, volume, area = hull(MESHES[name] + MIDDLE)
    write_stl(tmp_path / "stone.stl", corners)
    force, total, size = pressed(tmp_path, 3, f'shape = "{shape}"\nfile = "stone.stl"')
    assert np.abs(total).max() < 1e-12
    assert size == pytest.approx(area, rel=1e-6)
    assert force[2] == pytest.approx(WEIGHT * volume, rel=0.01)
    assert np.abs(force[:2]).max() < 0.01 * WEIGHT * volume


POLYGONS = {
    "triangle": [[0.25, 0.15], [0.55, 0.15], [0.4, 0.4]],
    "trapezoid": [[0.2, 0.15], [0.6, 0.15], [0.5, 0.35], [0.3, 0.35]],
    "hexagon": [
        [0.4 + 0.15 * np.cos(k), 0.27 + 0.15 * np.sin(k)] for k in np.pi / 3 * np.arange(6)
    ],
}


@pytest.mark.parametrize("name", POLYGONS)
@pytest.mark.parametrize("rotate", [0, 17])
def test_a_polygon_has_its_uplift(tmp_path, name, rotate):
    corners = np.array(POLYGONS[name])
    x, y = corners.T
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    stone = f'shape = "polygon"\nvertices = {corners.tolist()}\nrotate = {rotate}'
    force, total, size = pressed(tmp_path, 2, stone)
    assert np.abs(total).max() < 1e-12
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    assert size == pytest.approx(sides.sum())
    assert force[1] == pytest.approx(WEIGHT * area, rel=0.01)
    assert abs(force[0]) < 0.01 * WEIGHT * area


ROUND = {
    2: ('shape = "disc"\ncentre = [0.4, 0.27]\nradius = 0.12', np.pi * 0.12**2),
    3: ('shape = "sphere"\ncentre = [0.3, 0.3, 0.27]\nradius = 0.14', 4 / 3 * np.pi * 0.14**3),
}
BOXES = {
    2: ('shape = "box"\nmin = [0.3, 0.2]\nmax = [0.5, 0.4]', 0.2**2),
    3: ('shape = "box"\nmin = [0.2, 0.2, 0.14]\nmax = [0.4, 0.4, 0.34]', 0.2**3),
}


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("shapes", [ROUND, BOXES])
def test_a_body_of_rows_of_particles_has_its_uplift(tmp_path, dim, shapes):
    stone, measure = shapes[dim]
    force, _, _ = pressed(tmp_path, dim, stone)
    assert force[-1] == pytest.approx(WEIGHT * measure, rel=0.02)
    assert np.abs(force[:-1]).max() < 0.01 * WEIGHT * measure


@pytest.mark.parametrize("bent", [0.0, 0.1])
def test_a_sheet_has_both_sides_and_its_rims(tmp_path, bent):
    """A sheet of 0.08 m, flat or bent along a line: its outside is closed."""
    middle = [[0.3, 0.15, 0.2 + bent], [0.3, 0.45, 0.2 + bent]]
    left, right = [[0.15, 0.15, 0.2], [0.15, 0.45, 0.2]], [[0.45, 0.15, 0.2], [0.45, 0.45, 0.2]]
    quads = [(left[0], middle[0], middle[1], left[1]), (middle[0], right[0], right[1], middle[1])]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    write_stl(tmp_path / "sheet.stl", triangles)
    stone = 'shape = "mesh"\nfile = "sheet.stl"\nsheet = true\nthickness = 0.08'
    force, total, _ = pressed(tmp_path, 3, stone)
    volume = 0.3 * 2 * np.hypot(0.15, bent) * 0.08
    assert np.abs(total).max() < 1e-12
    assert force[2] == pytest.approx(WEIGHT * volume, rel=0.01)
    assert np.abs(force[:2]).max() < 0.01 * WEIGHT * volume


def test_pieces_are_small_and_fill_their_face():
    sliver = np.array([[[0, 0, 0], [1.0, 0, 0], [0, 0.01, 0]]])
    pieces = cut(sliver, 0.05)
    sides = np.linalg.norm(pieces - np.roll(pieces, 1, axis=1), axis=2)
    areas = 0.5 * np.cross(pieces[:, 1] - pieces[:, 0], pieces[:, 2] - pieces[:, 0])
    assert sides.max() <= 0.05
    np.testing.assert_allclose(areas.sum(axis=0), [0, 0, 0.005], atol=1e-15)
    assert len(pieces) < 300


def test_faces_go_where_their_body_goes(tmp_path):
    corners, _, _ = hull(CUBE + MIDDLE)
    write_stl(tmp_path / "stone.stl", corners)
    stone = 'shape = "mesh"\nfile = "stone.stl"\nmotion = { velocity = [0, 0.1, 0], start = 1 }'
    scenario = scenario_of(tmp_path, POOL[3] + REST + stone + GAUGE)
    faces = faces_of(scenario)["stone"]
    np.testing.assert_allclose(faces(1.0), cut(corners, 0.02), atol=1e-12)
    gone = faces(3.0) - faces(0.0)
    np.testing.assert_allclose(gone, np.broadcast_to([0, 0.2, 0], gone.shape), atol=1e-12)


@pytest.mark.parametrize("face", [90, 75, 60, 45])
def test_a_leaning_dam_of_triangles_holds_its_water(tmp_path, face):
    """It reaches into the floor and both sides; the moment is about its foot."""
    lean = 1 / np.tan(np.radians(face))
    sides = [(0.6 - 0.15 * lean, -0.15), (1.6, -0.15), (1.6, 0.6), (0.6 + 0.6 * lean, 0.6)]
    corners, _, _ = hull(np.array([(x, y, z) for y in (-0.15, 0.55) for x, z in sides]))
    write_stl(tmp_path / "dam.stl", corners)
    length = 0.05 * round((0.6 + 0.5 * lean) / 0.05 + 0.5)
    scenario = scenario_of(tmp_path, BANKS.format(file="dam.stl", length=length, ends=2))
    simulation, names = build_simulation(scenario)
    (reader,) = build_gauges(scenario, names)
    far = np.full(3, np.inf)
    found = reader.gauge.static(simulation, reader.setting, (-far, far))
    thrust = 0.5 * WEIGHT * 0.5**2 * 0.4
    np.testing.assert_allclose(found[:3], [thrust, 0, -thrust * lean], atol=0.02 * thrust)
    moment = thrust * 0.5 / 3 / np.sin(np.radians(face)) ** 2
    assert found[4] == pytest.approx(moment, rel=0.05)
