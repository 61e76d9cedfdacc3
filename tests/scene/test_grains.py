"""Bodies that move: particles, mass and inertia, packings, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.record.particles import BOUND, FREE
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.scene.packing import PackingError, pack, solid_fraction
from doseki.scene.shapes import Ball, box_shape, mesh_shape, polygon_shape
from doseki.solver.build import build_simulation
from doseki.solver.rigid_bodies import add_bodies, rigid_tables

from ..small_scenarios import BLOCK

TOP = 'scheme = "resolved"\nspeed_max = 2'
DISC = """
[body.stone]
shape = "disc"
material = "basalt"
centre = [0.5, 1.2]
radius = 0.5
"""
LOAD = """
[body.load]
shape = "disc"
material = "basalt"
min = [0, 0]
max = [10, 10]
d = 1
"""
FLOOR = """
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-1, -0.5]
max = [2, 0.699]
"""


def scene_of(write, tables, top=TOP, overrides=()):
    scenario = load_scenario(write(top=top, tables=tables), overrides)
    return scenario, build_scene(scenario)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("across", [5, 8, 8.37, 12])
def test_particles_of_a_ball(dim, across):
    ball = Ball(0.5 * across * 0.1, dim)
    position, normal, depth, curvature, share, _ = ball.particles(0.1)
    distance = np.linalg.norm(position, axis=1)
    assert distance.max() == pytest.approx(ball.radius - 0.05)
    assert depth == pytest.approx(ball.radius - distance)
    assert curvature == pytest.approx(1 / (ball.radius + 0.05))
    outer = distance > 1e-9
    assert np.allclose(normal[outer], position[outer] / distance[outer, None])
    assert np.allclose(position.mean(axis=0), 0, atol=1e-4 * ball.radius)
    assert share.sum() == pytest.approx(1)
    spacing = (share * ball.measure) ** (1 / dim)
    assert spacing == pytest.approx(np.full(len(share), 0.1), rel=0.25)
    gaps = np.linalg.norm(position[:, None] - position, axis=2) + np.eye(len(position))
    assert gaps.min() > 0.06
    assert gaps.min(axis=1).max() < 0.14


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("dp", [1.0, 0.1])
def test_no_two_particles_of_a_ball_are_in_one_place(dim, dp):
    for steps in range(50, 401):
        ball = Ball(dp * steps / 100, dim)
        for made in (ball.particles(dp), ball.elastic_particles(dp)):
            position, share = made.position, made.share
            distance = cKDTree(position).query(position, k=2)[0][:, 1]
            assert distance.min() > 0.3 * dp, f"{steps / 100} dp"
            assert share.sum() == pytest.approx(1)
            assert np.abs(share @ position).max() < 1e-12 * dp


def test_inertia_of_polygon_and_box():
    shape, centre = polygon_shape(np.array([[0, 0], [3, 0], [3, 2], [0, 2.0]]))
    assert centre == pytest.approx([1.5, 1])
    assert shape.measure == pytest.approx(6)
    assert shape.inertia[2, 2] == pytest.approx(13 / 12)
    triangle, centre = polygon_shape(np.array([[0, 0], [0, 1], [1, 0.0]]))  # clockwise
    assert (triangle.measure, triangle.inertia[2, 2]) == pytest.approx((0.5, 1 / 9))
    assert centre == pytest.approx([1 / 3, 1 / 3])
    normal, distance = triangle.planes
    assert (distance > 0).all()
    assert triangle.width == pytest.approx(np.sqrt(0.5))
    cuboid = box_shape(np.array([1.0, 2, 3]))
    assert np.diag(cuboid.inertia) == pytest.approx([13 / 12, 10 / 12, 5 / 12])
    assert len(cuboid.planes[0]) == 6
    position, normal, depth, curvature, share, _ = cuboid.particles(0.25)
    assert not curvature.any()
    assert share == pytest.approx([1 / (4 * 8 * 12)] * len(position))
    gaps = np.array([0.5, 1, 1.5]) - abs(position)
    assert depth == pytest.approx(gaps.min(axis=1))
    nearest = np.isclose(gaps, depth[:, None])
    assert np.allclose(abs(normal), nearest / np.sqrt(nearest.sum(axis=1))[:, None])
    assert np.array_equal(np.sign(normal), nearest * np.sign(position))
    samples = {tuple(p) for p in abs(cuboid.samples(0.5)).round(9)}
    assert samples >= {(0.5, 1, 1.5), (0, 1, 1.5)}
    assert (0, 0, 1.5) not in samples


@pytest.mark.parametrize(("dim", "fraction"), [(2, 0.8), (3, 0.55)])
def test_packing_reaches_its_fraction_without_overlap(dim, fraction):
    radius = np.random.default_rng(3).choice([0.4, 0.5], 200)
    side = (solid_fraction(radius, np.zeros(dim), np.ones(dim)) / fraction) ** (1 / dim)
    low, high = np.full(dim, -1.0), np.full(dim, side - 1)
    centre = pack(radius, low, high, seed=1)
    assert (centre - radius[:, None] >= low - 1e-12).all()
    assert (centre + radius[:, None] <= high + 1e-12).all()
    gap = np.linalg.norm(centre[:, None] - centre, axis=2) - radius[:, None] - radius
    assert gap[~np.eye(len(radius), dtype=bool)].min() >= 0
    assert np.array_equal(centre, pack(radius, low, high, seed=1))
    assert not np.array_equal(centre, pack(radius, low, high, seed=2))


def test_packing_that_cannot_be_reached():
    with pytest.raises(PackingError) as caught:
        pack(np.full(30, 0.5), np.zeros(2), np.full(2, 5.0), seed=1)
    asked = solid_fraction(np.full(30, 0.5), np.zeros(2), np.full(2, 5.0))
    assert 0.4 * asked < caught.value.reached < asked


def test_a_disc_is_one_body_and_water_makes_room(write):
    tables = BLOCK.replace("[1, 0.5]", "[2, 2]") + DISC + "velocity = [1, 2]\nspin = 3\n"
    scenario, scene = scene_of(write, tables)
    particles, bodies = scene.particles, scene.bodies
    stone = particles.motion == BOUND
    assert particles.mass[stone].sum() == pytest.approx(2750 * np.pi * 0.25)
    assert np.array_equal(bodies.grain >= 0, stone)
    arm = particles.position[stone] - [0.5, 1.2]
    assert np.allclose(particles.velocity[stone], [1, 2] + 3 * np.stack([-arm[:, 1], arm[:, 0]], 1))
    water = particles.position[particles.motion == FREE]
    assert np.linalg.norm(water - [0.5, 1.2], axis=1).min() >= 0.5
    assert 2 * 2 * 100 - len(water) == pytest.approx(np.pi * 25, rel=0.1)
    shapes, table = rigid_tables(scenario, bodies, scene.names)
    assert shapes == [{"radius": 0.5}]
    assert table["inertia"][0, 2, 2] == pytest.approx(2750 * np.pi * 0.5**4 / 2)
    assert (table["velocity"][0].tolist(), table["spin"][0].tolist()) == ([1, 2], [0, 0, 3])


@pytest.mark.parametrize(
    ("shape", "area"),
    [
        ('shape = "disc"\ncentre = [1, 1]\nradius = 0.5', np.pi * 0.25),
        ('shape = "box"\nmin = [0.52, 0.52]\nmax = [1.42, 1.42]', 0.81),
        ('shape = "box"\nmin = [0.6, 0.6]\nmax = [1.4, 1.4]\nrotate = 30\npivot = [1, 1]', 0.64),
        ('shape = "polygon"\nvertices = [[0.48, 0.48], [1.48, 0.48], [0.48, 1.48]]', 0.5),
    ],
    ids=["disc", "box off the lattice", "box turned", "triangle"],
)
def test_water_makes_room_for_what_is_fixed(write, shape, area):
    """With bodies that move beside it, and without."""
    water = BLOCK.replace("[1, 0.5]", "[2, 2]")
    fixed = f'[body.fixed]\nmaterial = "basalt"\nfixed = true\n{shape}\n'
    for more in ("", DISC.replace("[0.5, 1.2]", "[3.5, 1.2]")):
        _, scene = scene_of(write, water + fixed + more)
        particles = scene.particles
        left = particles.motion == FREE
        assert (left.sum() - 400) * 0.01 == pytest.approx(-area, abs=0.08)
        gap, _ = cKDTree(particles.position[~left]).query(particles.position[left])
        assert gap.min() > 0.03


def test_a_disc_across_a_periodic_side(write):
    """It is whole on both sides, in the water and when it moves."""
    top = TOP + '\nperiodic = ["x"]\ndomain_min = [0, -1]\ndomain_max = [2, 3]'
    tables = BLOCK.replace("[1, 0.5]", "[2, 2]") + DISC.replace("[0.5, 1.2]", "[0.1, 1]")
    _, scene = scene_of(write, tables, top)

    def from_centre(position, x):
        offset = position - [x, 1]
        offset[:, 0] -= 2 * np.rint(offset[:, 0] / 2)
        return np.linalg.norm(offset, axis=1)

    particles, stone = scene.particles, scene.particles.motion == BOUND
    assert from_centre(particles.position[stone], 0.1).max() == pytest.approx(0.45)
    assert from_centre(particles.position[~stone], 0.1).min() >= 0.5
    scenario = load_scenario(write(top=top, tables=DISC.replace("[0.5, 1.2]", "[0.1, 1]")), [])
    simulation, _ = build_simulation(scenario)
    simulation.advance(limit=0.01, pause=0.01, max_steps=10**6)
    state = simulation.state()
    assert from_centre(state["position"], 0.1).max() == pytest.approx(0.45)


def test_fixed_bodies_are_what_grains_touch(write):
    grit = '\n[body.g]\nshape = "points"\nmaterial = "basalt"\nfixed = true\nmass = 27.5\n'
    grit += "normal = [0, 1]\nposition = [[-0.5, 0.8], [-0.7, 0.8]]\n"
    scenario, scene = scene_of(write, FLOOR + "rotate = 0\n" + grit + DISC)
    calls = {}

    class Fake:
        def add_shapes(self, shapes):
            calls["shapes"] = shapes

        def add_rigid_bodies(self, table):
            calls["bodies"] = table

        def bind_points(self, grain):
            calls["grain"] = grain

    add_bodies(Fake(), scenario, scene.bodies, scene.names)
    assert [len(shape.get("vertices", ())) for shape in calls["shapes"]] == [0, 4, 0]
    assert calls["shapes"][2] == {"radius": pytest.approx(0.05)}
    assert calls["bodies"]["fixed"].tolist() == [False, True, True, True]
    assert calls["bodies"]["body"].tolist() == [
        scene.names.index(n) for n in ("stone", "floor", "g", "g")
    ]
    assert set(calls["grain"]) == {-1, 0}
    assert len(calls["grain"]) == len(scene.particles)


def test_without_bodies_that_move_nothing_is_added(write):
    _, scene = scene_of(write, BLOCK + FLOOR.replace("0.699", "0"))
    assert len(scene.bodies) == 0


def test_mass_and_grading(write):
    load = LOAD + 'mass_total = "110 t"\nwidth = 2\npacking = 0.7\n'
    _, scene = scene_of(write, load)
    assert len(scene.bodies) == round(55000 / 2750 / (np.pi / 4))
    level = len(scene.bodies) * np.pi / 4 / 0.7 / 10
    assert scene.bodies.groups[0].centre[:, 1].max() == pytest.approx(level - 0.5, abs=0.1)
    graded = load.replace("d = 1\n", "grading = [[1, 3], [0.5, 1]]\n")
    _, scene = scene_of(write, graded)
    group = scene.bodies.groups[0]
    shares = [np.sum(group.shape == k) * group.shapes[k].measure for k in (0, 1)]
    assert shares[0] / shares[1] == pytest.approx(3, rel=0.1)
    _, scene = scene_of(write, LOAD + 'count = 3\nkinematics = "single"\n')
    assert scene.particles.mass == pytest.approx([2750 * np.pi / 4] * 3)


@pytest.mark.parametrize(
    ("tables", "parts"),
    [
        (DISC + "damping = 0.1", ["body.stone.damping", 'only kinematics = "elastic"']),
        (DISC + 'kinematics = "soft"', ["kinematics = 'soft' is not allowed", "'rigid'"]),
        (DISC + "jitter = 0.1", ["body.stone.jitter", "moves as a whole"]),
        (DISC + "spin = [1, 0, 0]", ["body.stone.spin", "must be a number"]),
        (DISC + "fixed = true\nspin = 1", ["body.stone.spin", "not fixed"]),
        (BLOCK + "spin = 1", ["body.block.spin", "only solids"]),
        (DISC + FLOOR.replace("0.699", "0.75"), ["body.stone", "overlaps floor by 0.05 m"]),
        (DISC + DISC.replace("stone", "b"), ["body.stone", "overlaps b by 1 m"]),
        (
            FLOOR + FLOOR.replace("floor", "slab").replace("fixed = true\n", ""),
            ["body.slab", "overlaps floor"],
        ),
        (
            LOAD.replace("10, 10", "4, 4") + "packing = 0.9",
            ["body.load", "fraction of 0.8", "was reached"],
        ),
        (LOAD + "count = 110\npacking = 0.7", ["body.load", "110 grains", "do not fit", "0.864"]),
        (LOAD + "count = 1\nmass_total = 3", ["count and mass_total exclude each other"]),
        (LOAD + "grading = [[1, 1]]", ["give either d or grading"]),
        (LOAD + 'mass_total = "3 lb"', ["body.load.mass_total", 'such as "20 kg"']),
        (LOAD + "mass_total = 1", ["body.load", "not one grain"]),
        (
            LOAD.replace("basalt", "water"),
            ["body.load", "water is a fluid", "choose a solid material"],
        ),
        (
            DISC.replace("disc", "stl")
            .replace("centre", "file = 'a.stl'\ncentre")
            .replace("radius = 0.5", ""),
            ["3-D run"],
        ),
        (
            "[material.basalt]\nfriction = -0.1" + DISC,
            ["material.basalt.friction = -0.1", "at least 0"],
        ),
        ("[material.basalt]\nrestitution = 1.1" + DISC, ["restitution = 1.1", "at most 1"]),
        ("[material.basalt]\nrestitution = 0" + DISC, ["restitution = 0", "greater than 0"]),
        ("[material.basalt]\npoisson_ratio = 0.5" + DISC, ["poisson_ratio = 0.5", "less than 0.5"]),
        ("[contact]\nlaw = 'hert'" + DISC, ["contact.law = 'hert'", "'hertz'"]),
        ("[contact]\noverlap = 0.2" + DISC, ["contact.overlap = 0.2", "at most 0.1"]),
        ("[contact]\nsteps = 2" + DISC, ["contact.steps = 2", "at least 5"]),
        ("[contact]\nspeed = 0" + DISC, ["contact.speed = 0", "greater than 0"]),
        ("[material.basalt]\nrolling_friction = -1" + DISC, ["rolling_friction = -1"]),
        ("[material.basalt]\nyoung_modulus = 0" + DISC, ["young_modulus = 0", "greater than 0"]),
        (
            FLOOR.replace("fixed = true\n", 'kinematics = "single"\n'),
            ["body.floor", "one particle per disc", 'shape = "box"'],
        ),
        (
            LOAD.replace("d = 1\n", "grading = [[1, -1]]\n"),
            ["body.load.grading"],
        ),
        (LOAD.replace("max = [10, 10]", "max = [-1, 10]"), ["every entry of min must be below"]),
        (LOAD + "packing = 1.2", ["body.load.packing = 1.2", "less than 1"]),
        (LOAD + "count = 0", ["body.load.count = 0", "greater than 0"]),
        ("[contact]\noverlp = 0.1" + DISC, ["contact.overlp is not a known key", "overlap"]),
    ],
)
def test_errors(write, error_of, tables, parts):
    text = error_of(write(top=TOP, tables=tables))
    assert all(part in text for part in parts), text


def test_the_other_scheme_has_no_such_bodies(write, error_of):
    assert 'scheme = "resolved"' in error_of(write(tables=LOAD))
    assert "only solids of the resolved" in error_of(write(tables=DISC + 'kinematics = "rigid"'))


def test_a_body_of_few_particles_is_told(write):
    _, scene = scene_of(write, DISC.replace("radius = 0.5", "radius = 0.2"))
    assert any("stone: 4 particles across" in str(doubt) for doubt in scene.warnings)
    _, scene = scene_of(write, DISC)
    assert scene.warnings == []


def test_contact_can_be_set_and_is_kept(write, tmp_path):
    path = write(top=TOP, tables=DISC)
    scenario = load_scenario(path, ["contact.stiffness=material", "contact.steps=30"])
    (tmp_path / "again.toml").write_text(scenario.effective_toml())
    again = load_scenario(str(tmp_path / "again.toml"))
    assert (again.contact.stiffness, again.contact.steps) == ("material", 30)
    assert again.effective_toml() == scenario.effective_toml()


def test_elastic_constants_follow_from_table_1(write):
    materials = load_scenario(write()).materials
    assert materials["aluminium"].elasticity == pytest.approx((68.7e9, 0.347), rel=0.01)
    assert materials["basalt"].elasticity == pytest.approx((53.1e9, 0.169), rel=0.01)


@pytest.mark.parametrize("kind", ["open", "hollow", "whole"])
def test_stl(tmp_path, kind):
    import trimesh

    from doseki.scene.shapes import ShapeError

    mesh = trimesh.creation.box((1, 2, 3))
    if kind == "open":
        mesh.update_faces(np.arange(11))
    if kind == "hollow":
        mesh = trimesh.creation.annulus(0.5, 1, 1)
    mesh.export(tmp_path / "a.stl")
    if kind == "whole":
        shape, centre = mesh_shape(tmp_path / "a.stl", 0.1)
        assert shape.measure == pytest.approx(6e-3)
        assert centre == pytest.approx(np.zeros(3), abs=1e-9)
        assert np.diag(shape.inertia) == pytest.approx(np.array([13, 10, 5]) / 1200)
        return
    with pytest.raises(ShapeError, match="not closed" if kind == "open" else "not convex"):
        mesh_shape(tmp_path / "a.stl", 0.1)
