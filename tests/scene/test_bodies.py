"""From shapes to particles: how many, where, how heavy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from doseki.record.particles import FIXED, FREE, ParticleSet, concatenate
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies, build_scene
from doseki.scene.checks.particle_overlaps import TOO_NEAR, find_overlaps
from doseki.scene.lattices import rotated

from ..small_scenarios import BLOCK


def particles_at(position, spacing=0.1):
    """Water at rest at these positions, all of body 0."""
    n, dim = position.shape
    return ParticleSet(
        position=position,
        velocity=np.zeros((n, dim)),
        mass=1000.0 * np.broadcast_to(spacing, n) ** dim,
        density=np.full(n, 1000.0),
        smoothing_length=np.full(n, 0.12),
        material=np.zeros(n, np.int32),
        body=np.zeros(n, np.int32),
        motion=np.zeros(n, np.int32),
        id=np.arange(n),
    )


def build(path, *overrides):
    return build_bodies(load_scenario(path, overrides))[0]


def test_box_is_a_lattice_half_a_spacing_inside(write):
    particles = build(write())
    assert len(particles) == 50
    np.testing.assert_allclose(particles.position.min(axis=0), [0.05, 0.05])
    np.testing.assert_allclose(particles.position.max(axis=0), [0.95, 0.45])
    np.testing.assert_allclose(particles.mass, 1000 * 0.1**2)
    np.testing.assert_allclose(particles.smoothing_length, 1.2 * 0.1)
    np.testing.assert_array_equal(particles.id, np.arange(50))


def test_count_fills_rows_from_below(write):
    position = build(write(), "body.block.count=23").position
    assert len(position) == 23
    np.testing.assert_allclose(np.unique(position[:20, 1]), [0.05, 0.15])
    np.testing.assert_allclose(position[20:], [[0.05, 0.25], [0.15, 0.25], [0.25, 0.25]])


def test_rotation_keeps_the_pivot_and_turns_x_towards_the_last_axis():
    for dim in (2, 3):
        pivot = np.arange(1.0, dim + 1)
        turned = rotated(pivot + np.eye(dim), 90, pivot)
        np.testing.assert_allclose(turned[0], pivot + np.eye(dim)[-1], atol=1e-15)
        np.testing.assert_allclose(turned[-1], pivot - np.eye(dim)[0], atol=1e-15)


def test_rotation_about_a_given_axis_is_right_handed():
    turned = rotated(np.array([[1.0, 0, 0]]), 90, np.zeros(3), np.array([0, 0, 2.0]))
    np.testing.assert_allclose(turned, [[0, 1, 0]], atol=1e-15)


@settings(max_examples=30)
@given(st.floats(-720, 720), st.integers(2, 3))
def test_rotation_keeps_distances(degrees, dim):
    points = np.random.default_rng(0).normal(size=(5, dim))
    turned = rotated(points, degrees, np.ones(dim))
    for a, b in ((0, 1), (2, 4)):
        gap = np.linalg.norm(turned[a] - turned[b])
        assert gap == pytest.approx(np.linalg.norm(points[a] - points[b]))


def test_disc_and_single_particle_have_the_same_mass_to_the_lattice(write):
    tables = "[body.d]\nshape = 'disc'\nmaterial = 'water'\ncentre = [0, 0]\nradius = 1\n"
    ways = ["body.d.dp=0.0625"], ["body.d.fill=single"]
    lattice, single = (build(write(tables=tables), *way) for way in ways)
    assert (len(lattice), len(single)) == (793, 1)
    assert single.mass[0] == pytest.approx(1000 * np.pi)
    assert lattice.mass.sum() == pytest.approx(single.mass[0], rel=0.02)


def test_points_fixed_and_velocity(write):
    tables = "[body.p]\nshape = 'points'\nmaterial = 'water'\nposition = [[0, 0], [1, 2]]\nmass = 3"
    particles = build(write(tables=tables), "body.p.fixed=true", "body.p.velocity=['= x + 2*y', 4]")
    np.testing.assert_array_equal(particles.position, [[0, 0], [1, 2]])
    np.testing.assert_array_equal(particles.velocity, [[0, 4], [5, 4]])
    np.testing.assert_array_equal(particles.mass, 3)
    np.testing.assert_array_equal(particles.motion, FIXED)


def test_overlap_is_a_warning(write):
    scenario = load_scenario(write(tables=BLOCK + BLOCK.replace("block", "other")))
    (overlap,) = build_scene(scenario).warnings
    assert (overlap.place, overlap.other) == ("block", "other")
    assert str(overlap).startswith(f"block overlaps other: pairs of particles ({overlap.pairs}")


def test_bodies_that_touch_do_not_overlap(write):
    beside = BLOCK.replace("block", "other").replace("[1, 0.5]", "[2, 1]").replace("[0,", "[1,")
    scenario = load_scenario(write(tables=BLOCK + beside))
    scene = build_scene(scenario)
    assert (len(scene.particles), scene.names, scene.warnings) == (150, ["block", "other"], [])
    assert set(scene.particles.motion) == {FREE}


def test_nothing_at_all_is_an_empty_set():
    empty = concatenate([], dim=3)
    assert (len(empty), empty.dim, empty.body.dtype) == (0, 3, np.int32)


PRESSED = "body.block.pressure== 1000*9.81*(0.5 - y)"


def test_pressure_becomes_density_and_keeps_the_volume(write):
    """Linear: p = c^2 (rho - rho0) with the sound speed of the run."""
    particles = build(write("xi = 0.05"), PRESSED)
    pressure = 1000 * 9.81 * (0.5 - particles.position[:, 1])
    np.testing.assert_allclose((0.05 * 1400) ** 2 * (particles.density - 1000), pressure, rtol=1e-9)
    np.testing.assert_allclose(particles.mass / particles.density, 0.1**2)
    np.testing.assert_allclose(particles.smoothing_length, 1.2 * 0.1)


def test_pressure_may_be_a_number(write):
    density = build(write(), "body.block.pressure=1.96e6").density
    np.testing.assert_allclose(density, 1001.0)


def test_pressure_beyond_all_tension_is_refused(write, error_of):
    assert "tension" in error_of(write(), "body.block.pressure=-1e10")


def test_bad_pressure_names_its_key(write, error_of):
    assert "body.block.pressure" in error_of(write(), "body.block.pressure== 1/(y - y)")
    assert "body.block.pressure" in error_of(write(), "body.block.pressure=high")


def test_where_keeps_part_of_a_body(write):
    position = build(write(), "body.block.where== 0.5 - x - y").position
    full = build(write()).position
    np.testing.assert_array_equal(position, full[0.5 - full.sum(axis=1) > 0])


def test_where_must_leave_something(write, error_of):
    assert "body.block.where" in error_of(write(), "body.block.where== -1 - x")


def test_a_wetted_box_is_whole(write, error_of):
    both = ("body.block.wetted_by=water", "body.block.where== 1 - x")
    assert "exclude each other" in error_of(write(), *both)


def test_a_heap_in_one_point_is_noticed_without_all_of_its_pairs():
    n = 3000
    heap = particles_at(np.zeros((n, 2)))
    (overlap,) = find_overlaps(heap, ["heap"])
    assert n / 2 <= overlap.pairs < 10 * n


def test_overlaps_are_those_of_all_pairs():
    """Against every distance, with particles of two sizes."""
    random = np.random.default_rng(5)
    heap = particles_at(random.uniform(0, 1, (300, 3)), spacing=random.choice([0.1, 0.2], 300))
    heap.body[150:] = 1
    apart = np.linalg.norm(heap.position[:, None] - heap.position, axis=2)
    size = np.cbrt(heap.mass / heap.density)
    near = np.triu(apart < TOO_NEAR * np.minimum(size[:, None], size), k=1)
    found = {(o.place, o.other): o.pairs for o in find_overlaps(heap, ["a", "b"])}
    first, second = heap.body[np.nonzero(near)[0]], heap.body[np.nonzero(near)[1]]
    for name, pair in (("a", 0), ("b", 1)):
        assert found[name, name] == ((first == pair) & (second == pair)).sum()
    assert found["a", "b"] == (first != second).sum() > 0


ELASTIC_BALLS = """
dim = {dim}
dp = 0.01
scheme = "resolved"
time_max = 1
time_out = 1
speed_max = 1
[material.rubber]
law = "solid"
rho0 = 1000
speedsound = 90
young_modulus = 1e7
poisson_ratio = 0.3
"""
BREAKS = """
fracture = "cohesive"
tensile_strength = 1e6
fracture_energy = 1e5
"""
BALL = """
[body.{name}]
shape = "{shape}"
material = "rubber"
kinematics = "elastic"
radius = 0.05
centre = {centre}
"""


@pytest.mark.parametrize(
    ("dim", "balls", "breaks", "told"),
    [(3, 2, True, True), (3, 1, True, False), (2, 2, True, False), (3, 2, False, False)],
)
def test_what_touches_as_balls_is_told(tmp_path, dim, balls, breaks, told):
    text = ELASTIC_BALLS.format(dim=dim) + (BREAKS if breaks else "")
    for n in range(balls):
        centre = [0.2 * n + 0.1] * dim
        shape = "sphere" if dim == 3 else "disc"
        text += BALL.format(name=f"b{n}", shape=shape, centre=centre)
    path = tmp_path / "case.toml"
    path.write_text(text)
    said = " ".join(map(str, build_scene(load_scenario(str(path))).warnings))
    assert ("layers of balls" in said) == told
