"""The laws of contact against closed forms, and against their equations of motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp


@pytest.mark.parametrize("restitution", [0.1, 0.2, 0.5, 0.9, 0.98])
@pytest.mark.parametrize("hertz", [False, True])
def test_a_contact_gives_back_its_restitution(physics, restitution, hertz):
    """The force that never pulls, followed from first touch to parting."""
    ((zeta,),) = physics.damping_ratio([[restitution], [float(hertz)]])
    stiffness, radius, mass, speed = 1e6, 0.005, 1.4e-3, 2.0

    def motion(_time, state):
        overlap, approach = state
        row = [float(hertz), zeta, stiffness, radius, mass, max(overlap, 0.0), approach]
        ((force,),) = physics.contact_force([[x] for x in row])
        return [approach, -force / mass]

    def parted(time, state):
        return state[0] if time > 0 else 1.0

    parted.terminal, parted.direction = True, -1
    encounter = physics.hertz_collision if hertz else physics.linear_collision
    row = [stiffness, radius, mass, speed] if hertz else [stiffness, mass, speed]
    _, (duration,) = encounter([[x] for x in row])
    path = solve_ivp(
        motion,
        (0, 20 * duration),
        [0, speed],
        events=parted,
        rtol=1e-8,
        atol=1e-12,
        max_step=duration / 50,
    )
    assert -path.y[1].min() / speed == pytest.approx(restitution, abs=2e-3)


def test_without_loss_there_is_no_damping(physics):
    assert physics.damping_ratio([[1.0, 1.0], [0.0, 1.0]])[0] == pytest.approx([0.0, 0.0], abs=2e-3)


def test_hertz_stiffness_is_the_slope_of_its_force(physics):
    overlap, step = np.geomspace(1e-7, 1e-4, 20), 1e-10

    def columns(x):
        return [[5e9] * len(x), [2.5e-3] * len(x), x.tolist()]

    force, slope = physics.hertz_spring(columns(overlap))
    above, _ = physics.hertz_spring(columns(overlap + step))
    below, _ = physics.hertz_spring(columns(overlap - step))
    assert (np.array(above) - below) / (2 * step) == pytest.approx(slope, rel=1e-5)
    assert force == pytest.approx(4 / 3 * 5e9 * np.sqrt(2.5e-3) * overlap**1.5, rel=1e-14)


def test_spheres_of_basalt_meet_as_hertz_says(physics):
    """10 mm, 6 m/s, K = 26.70 GPa, mu = 22.7 GPa: 2.459e-5 s, 50 um, 646 N."""
    young, poisson, radius = 53.06e9, 0.1688, 0.005
    mass = 2750 * 4 / 3 * np.pi * radius**3
    stiff, half_radius = young / (1 - poisson**2) / 2, radius / 2
    (overlap,), (time,) = physics.hertz_collision([[stiff], [half_radius], [mass / 2], [6.0]])
    (force,), _ = physics.hertz_spring([[stiff], [half_radius], [overlap]])
    assert overlap == pytest.approx(50e-6, rel=0.02)
    assert time == pytest.approx(2.459e-5, rel=2e-3)
    assert force == pytest.approx(646, rel=5e-3)


def spring(physics, stretch, speed, dt=1e-3, k=100.0, c=0.0, limit=1.0):
    row = [*stretch, *speed, dt, k, c, limit]
    out = np.array(physics.sliding_spring([[x] for x in row]))[:, 0]
    return out[:3], out[3:]


def test_friction_is_a_spring_until_it_slides(physics):
    force, stretch = spring(physics, [1e-3, 0, 0], [1.0, 0, 0])
    assert force == pytest.approx([-0.2, 0, 0])
    assert stretch == pytest.approx([2e-3, 0, 0])


def test_friction_slides_at_its_limit_and_forgets_the_rest(physics):
    force, stretch = spring(physics, [0.05, 0, 0], [0, 3.0, 0])
    assert np.linalg.norm(force) == pytest.approx(1.0)
    assert np.linalg.norm(stretch) == pytest.approx(0.01)
    assert np.dot(force, stretch) < 0


def test_without_pressure_there_is_no_friction(physics):
    force, stretch = spring(physics, [0.05, 0, 0], [0, 3.0, 0], limit=0.0)
    assert np.all(force == 0)
    assert np.all(stretch == 0)


SQUARE = [[-2, -1], [2, -1], [2, -1], [2, 1], [2, 1], [-2, 1], [-2, 1], [-2, -1]]


@pytest.mark.parametrize(
    ("point", "distance", "normal"),
    [
        ([0, 3], 2, [0, 1]),
        ([4, 0.5], 2, [1, 0]),
        ([5, 5], 5, [0.6, 0.8]),
        ([0, 0.7], -0.3, [0, 1]),
        ([-1.9, 0], -0.1, [-1, 0]),
    ],
)
def test_distance_from_a_polygon(physics, point, distance, normal):
    ((d, *n),) = physics.two.surface_from(SQUARE, [point])
    assert d == pytest.approx(distance)
    assert n == pytest.approx(normal)


def test_distance_from_a_tetrahedron(physics):
    """Against the nearest of many points of its surface."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    rng = np.random.default_rng(3)
    weights = rng.dirichlet([0.7] * 3, 20_000)
    surface = np.concatenate([weights @ corner[face] for face in faces])
    points = rng.uniform(-1, 1.5, (200, 3))
    out = np.array(
        physics.three.surface_from(
            np.concatenate([corner[f] for f in faces]).tolist(), points.tolist()
        )
    )
    inside = (points > 0).all(axis=1) & (points.sum(axis=1) < 1)
    nearest = np.array([np.linalg.norm(surface - p, axis=1).min() for p in points])
    assert np.abs(out[:, 0]) == pytest.approx(nearest, abs=0.03)
    assert np.array_equal(out[:, 0] < 0, inside)
    foot = points - out[:, :1] * out[:, 1:]
    gap = np.array([np.linalg.norm(surface - p, axis=1).min() for p in foot])
    assert gap.max() < 0.03
    assert np.linalg.norm(out[:, 1:], axis=1) == pytest.approx(1)
