"""Blocks that strike something: restitution and directions are those of rigid bodies."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import ball, body, box, head, moving, started

SPEED, RADIUS = 2.0, 0.03
LAWS = [(2, "linear"), (3, "linear"), (3, "hertz")]


@pytest.mark.parametrize("restitution", [1.0, 0.5])
@pytest.mark.parametrize("across", [5, 12])
@pytest.mark.parametrize(("dim", "law"), LAWS)
def test_a_block_that_lands_flat_has_its_restitution(tmp_path, dim, law, across, restitution):
    """Where each of many points damps as if it were alone, a half becomes a tenth or less."""
    side, level = 0.06, [0.0] * (dim - 1)
    dp = side / across
    text = head([0.0] * dim, dp, speed=3, law=law, restitution=restitution)
    text += box("bed", [*[-0.1] * (dim - 1), -4 * dp], [*[0.1] * (dim - 1), 0], fixed=True)
    low = [*[-side / 2] * (dim - 1), 0.001]
    text += box("block", low, np.add(low, side).tolist(), velocity=[*level, -SPEED])
    run = started(tmp_path, text)
    run.advance(0.01)
    assert moving(run, "velocity")[0] == pytest.approx(
        [*level, restitution * SPEED], abs=0.01 * SPEED
    )
    assert np.abs(moving(run, "spin")).max() < 1e-6


def landed_on_a_corner(folder, angle, restitution, turned=0.0):
    """Velocity and spin, in the frame of the bed, of a block that struck with one corner.

    The block is turned by `angle` against the bed, and all of it by `turned`, degrees.
    """
    w, h, dp = 0.06, 0.1, 0.005
    corners = rotation(angle) @ (np.array([[-1, -1, 1, 1], [-1, 1, -1, 1]]) * [[w / 2], [h / 2]])
    arm = corners[:, corners[1].argmin()]
    centre = np.array([0, 0.001 - arm[1]])
    text = head([0, 0], dp, speed=3, restitution=restitution, friction=0)
    bed = {"rotate": turned, "pivot": [0.0, 0.0]} if turned else {}
    text += box("bed", [-0.5, -4 * dp], [0.5, 0], fixed=True, **bed)
    middle, half = rotation(turned) @ centre, np.array([w, h]) / 2
    velocity = (rotation(turned) @ [0, -SPEED]).tolist()
    text += box("block", middle - half, middle + half, rotate=angle + turned, velocity=velocity)
    run = started(folder, text)
    run.advance(0.005)
    impulse = (1 + restitution) * SPEED / (1 + 12 * arm[0] ** 2 / (w**2 + h**2))
    exact = impulse - SPEED, 12 * arm[0] * impulse / (w**2 + h**2)
    return rotation(-turned) @ moving(run, "velocity")[0], moving(run, "spin")[0, 2], exact


def rotation(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


@pytest.mark.parametrize("restitution", [1.0, 0.5])
@pytest.mark.parametrize("angle", [30, -30, 45])
def test_a_corner_pushes_along_the_face_it_strikes(tmp_path, angle, restitution):
    """Without friction nothing pushes it sideways, and the block turns as a rigid one does."""
    (along, up), spin, (speed, turn) = landed_on_a_corner(tmp_path, angle, restitution)
    assert abs(along) < 1e-12
    assert up == pytest.approx(speed, abs=0.03 * SPEED)
    assert spin == pytest.approx(turn, rel=0.04, abs=0.02 * SPEED / 0.1)


def test_a_corner_strikes_a_turned_bed_alike(tmp_path):
    level, turned = (landed_on_a_corner(tmp_path, 45, 0.5, turn) for turn in (0, 20))
    assert turned[0] == pytest.approx(level[0], abs=1e-6)
    assert turned[1] == pytest.approx(level[1], rel=1e-6)


@pytest.mark.parametrize("restitution", [1.0, 0.5])
@pytest.mark.parametrize(("dim", "law"), LAWS)
def test_a_ball_strikes_the_end_of_a_plank_that_is_free(tmp_path, dim, law, restitution):
    """The contact brakes less than the whole of the plank, which turns away."""
    size, arm = np.array([0.3, *[0.1] * (dim - 2), 0.06]), 0.14
    mass = 2000 * size.prod(), 2000 * (np.pi * RADIUS**2 if dim == 2 else 4 / 3 * np.pi * RADIUS**3)
    inertia = mass[0] * (size[0] ** 2 + size[-1] ** 2) / 12
    impulse = (1 + restitution) * SPEED / (1 / mass[0] + 1 / mass[1] + arm**2 / inertia)
    text = head([0.0] * dim, 0.01, speed=3, law=law, restitution=restitution)
    text += box("plank", (-size / 2).tolist(), (size / 2).tolist())
    level = [0.0] * (dim - 2)
    centre = [arm, *level, size[-1] / 2 + RADIUS + 0.002]
    text += ball("ball", centre, RADIUS, velocity=[0.0, *level, -SPEED])
    run = started(tmp_path, text)
    run.advance(0.01)
    plank, striker = moving(run, "velocity")[:, -1]
    assert striker == pytest.approx(impulse / mass[1] - SPEED, abs=0.01 * SPEED)
    assert plank == pytest.approx(-impulse / mass[0], rel=0.01)
    turn = moving(run, "spin")[0, 2 if dim == 2 else 1] * (-1 if dim == 2 else 1)
    assert turn == pytest.approx(arm * impulse / inertia, rel=0.01)


def energy_and_momenta(run, inertia):
    """Of bodies of one mass that turn alike about all axes, over that mass."""
    velocity, spin = (moving(run, field) for field in ("velocity", "spin"))
    centre, velocity = (
        np.pad(rows, ((0, 0), (0, 3 - rows.shape[1]))) for rows in (moving(run, "centre"), velocity)
    )
    energy = 0.5 * (velocity**2).sum() + 0.5 * inertia * (spin**2).sum()
    angular = np.cross(centre, velocity).sum(axis=0) + inertia * spin.sum(axis=0)
    return energy, np.concatenate([velocity.sum(axis=0), angular])


@pytest.mark.parametrize(("dim", "law"), LAWS)
@pytest.mark.parametrize("seed", range(12))
def test_blocks_that_meet_anyhow_keep_energy_and_momenta(tmp_path, seed, dim, law):
    """The bodies step as they like to the end: steps must be short before the first touch.

    In space some is lost where edges cross, and none is made.
    """
    side, rng = 0.06, np.random.default_rng(seed)
    text = head([0.0] * dim, 0.01, speed=4, law=law, restitution=1.0, friction=0)
    aside = rng.uniform(-0.02, 0.02, size=dim - 1)
    ways = ("left", [-0.06, *[0.0] * (dim - 1)], 2.0), ("right", [0.06, *aside], -1.0)
    for name, centre, speed in ways:
        turned = {"rotate": rng.uniform(0, 360)}
        if dim == 3:
            axis = rng.normal(size=3)
            turned["rotate_axis"] = (axis / np.linalg.norm(axis)).tolist()
        low, high = np.subtract(centre, side / 2), np.add(centre, side / 2)
        text += box(name, low, high, velocity=[speed, *[0.0] * (dim - 1)], **turned)
    run = started(tmp_path, text)
    before, momenta = energy_and_momenta(run, side**2 / 6)
    run.advance(0.06)
    after, kept = energy_and_momenta(run, side**2 / 6)
    assert np.abs(moving(run, "spin")).max() > 1  # they have met
    assert (0.98 if dim == 2 else 0.8) < after / before < 1.01
    assert kept == pytest.approx(momenta, abs=1e-12)


@pytest.mark.parametrize(("dim", "law"), LAWS)
def test_balls_that_meet_anywhere_in_a_long_step_keep_their_energy(tmp_path, dim, law):
    """They are too far apart at the start to be known as a pair."""
    for apart in np.linspace(0.09, 0.14, 12):
        text = head([0.0] * dim, 0.01, speed=4, law=law, restitution=1.0, friction=0)
        for name, at, speed in (("left", -apart / 2, 2.0), ("right", apart / 2, -1.0)):
            aside = [0.0] * (dim - 1)
            text += ball(name, [at, *aside], RADIUS, velocity=[speed, *aside])
        run = started(tmp_path, text)
        run.advance(0.06)
        assert moving(run, "velocity")[:, 0] == pytest.approx([-1, 2], abs=0.003)


@pytest.mark.parametrize("shape", ["box", "ball"])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_plate_that_moves_drives_what_is_at_rest(tmp_path, dim, shape):
    """It would have gone through within one step of the run: nothing else moves."""
    aside = [0.0] * (dim - 1)
    text = head([0.0] * dim, 0.01, speed=4, restitution=1.0, friction=0)
    motion = f"{{ velocity = {[1.0, *aside]}, start = 0.02, stop = 0.2 }}"
    low, high = [-0.2, *[-0.05] * (dim - 1)], [-0.1, *[0.05] * (dim - 1)]
    text += box("plate", low, high, fixed=True, motion=motion)
    middle = np.array([0.013, *aside])
    if shape == "box":
        text += box("struck", middle - RADIUS, middle + RADIUS)
    else:
        text += ball("struck", middle, RADIUS)
    run = started(tmp_path, text)
    run.advance(0.3)
    assert moving(run, "velocity")[0] == pytest.approx([2, *aside], abs=0.01)


def test_a_polygon_of_many_sides_has_corners(tmp_path):
    """However little its sides turn: one without corners would fall through the bed."""
    turns = 2 * np.pi * np.arange(200) / 200 + 0.1
    around = RADIUS * np.column_stack([np.cos(turns), np.sin(turns)])
    text = head([0, 0], 0.005, speed=3, restitution=0.5, friction=0)
    text += box("bed", [-0.5, -0.02], [0.5, 0], fixed=True)
    vertices = np.add(around, [0, 0.002 - around[:, 1].min()]).tolist()
    text += body("wheel", "polygon", vertices=vertices, velocity=[0.0, -SPEED])
    run = started(tmp_path, text)
    run.advance(0.01)
    assert moving(run, "velocity")[0] == pytest.approx([0, 0.5 * SPEED], abs=0.01 * SPEED)
