"""Fixed bodies that lie flush in one plane are one surface for what lands on them."""

from __future__ import annotations

import numpy as np
import pytest

from .blocks import assert_restored_with_the_same_bits, body, box, head, moving, started

SPEED, DP = 2.0, 0.02
SIZE = np.array([0.16, 0.12, 0.08])
DIMS = [2, 3]


def rotation(degrees):
    """About y; in 2-D clockwise as well."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, s], [-s, c]])


def bed(dim, name, start, end, top=0.0, **values):
    low, high = [start, *[-0.3] * (dim - 2), top - 0.08], [end, *[0.3] * (dim - 2), top]
    return box(name, low, high, fixed=True, **values)


def landed(
    folder,
    dim,
    beds,
    *,
    restitution=0.5,
    friction=0.3,
    along=0.0,
    turned=0.0,
    until=0.01,
    law="linear",
    period=None,
):
    """Speed across the bed and greatest spin of a block after it has struck with its flat side.

    All is turned by `turned` about the origin, degrees.
    """
    text = head([0.0] * dim, DP, speed=3, restitution=restitution, friction=friction, law=law)
    if period is not None:
        low, high = [period[0], *[-1.0] * (dim - 1)], [period[1], *[1.0] * (dim - 1)]
        keys = f'periodic = ["x"]\ndomain_min = {low}\ndomain_max = {high}\n\n[contact]'
        text = text.replace("\n[contact]", keys)
    size = SIZE if dim == 3 else SIZE[[0, 2]]
    low = np.array([-size[0] / 2, *[-size[1] / 2] * (dim - 2), 0.001])
    high = low + size
    way = np.zeros(dim)
    way[[0, -1]] = rotation(turned) @ [along, -SPEED]
    how = turn(dim, turned)
    text += "".join(bed(dim, name, *ends, **how) for name, ends in beds.items())
    text += box("block", low, high, velocity=way.tolist(), **how)
    run = started(folder, text)
    run.advance(until)
    velocity = rotation(-turned) @ moving(run, "velocity")[0][[0, -1]]
    return velocity[1], np.abs(moving(run, "spin")).max()


def turn(dim, degrees):
    if not degrees:
        return {}
    if dim == 2:
        return {"rotate": -degrees, "pivot": [0.0, 0.0]}
    return {"rotate": degrees, "rotate_axis": [0.0, 1.0, 0.0], "pivot": [0.0, 0.0, 0.0]}


WHOLE = {"bed": (-0.5, 0.5)}


def two(seam):
    return {"left": (-0.5, seam), "right": (seam, 0.5)}


def assert_as_on_one(found, one):
    assert found[1] < 1e-6
    assert found[0] == pytest.approx(one[0], rel=1e-3)


@pytest.mark.parametrize("seam", [0.06, -0.031, 0.04])
@pytest.mark.parametrize("restitution", [0.5, 1.0])
@pytest.mark.parametrize(("dim", "law"), [(2, "linear"), (3, "linear"), (3, "hertz")])
def test_a_block_lands_across_a_seam_as_on_one_bed(tmp_path, dim, law, restitution, seam):
    """It got spin where each bed had a spring of its own, and where their corners pushed it."""
    values = {"restitution": restitution, "law": law}
    one = landed(tmp_path, dim, WHOLE, **values)
    assert_as_on_one(landed(tmp_path, dim, two(seam), **values), one)


@pytest.mark.parametrize("dim", DIMS)
def test_a_seam_that_is_turned_is_one_as_well(tmp_path, dim):
    one = landed(tmp_path, dim, WHOLE, turned=25)
    assert_as_on_one(landed(tmp_path, dim, two(0.05), turned=25), one)


@pytest.mark.parametrize("dim", DIMS)
def test_a_narrow_piece_between_two_changes_nothing(tmp_path, dim):
    beds = {"middle": (0.0, 0.04), "left": (-0.5, 0.0), "right": (0.04, 0.5)}
    assert_as_on_one(landed(tmp_path, dim, beds), landed(tmp_path, dim, WHOLE))


@pytest.mark.parametrize("dim", DIMS)
@pytest.mark.parametrize("seam", [0.06, -0.02])
def test_a_bed_goes_on_over_its_period(tmp_path, dim, seam):
    """Whole, or of two pieces, with a seam of its own and its end below the block."""
    one = landed(tmp_path, dim, WHOLE)
    start, end = seam - 0.8, seam
    whole = {"bed": (start, end)}
    assert_as_on_one(landed(tmp_path, dim, whole, period=(start, end)), one)
    pieces = {"bed": (start, -0.06), "rest": (-0.06, end)}
    assert_as_on_one(landed(tmp_path, dim, pieces, period=(start, end)), one)


@pytest.mark.parametrize("dim", DIMS)
@pytest.mark.parametrize("beyond", [0.0, 1e-6, 1e-5, 1e-4, 1e-3])
def test_a_corner_lands_beside_the_end_of_a_period(tmp_path, dim, beyond):
    """It is deeper than it is away from the side of the bed, which its next image covers."""
    one = landed(tmp_path, dim, WHOLE)
    for end in (0.08 - beyond, -0.08 + beyond):
        start = end - 0.8
        assert_as_on_one(landed(tmp_path, dim, {"bed": (start, end)}, period=(start, end)), one)
        assert_as_on_one(landed(tmp_path, dim, two(end)), one)


def test_a_block_lands_over_the_edge_of_two_beds(tmp_path):
    """The ends of both at the seam are one point of that edge."""
    found = []
    for beds in (WHOLE, two(0.0)):
        text = head([0.0] * 3, DP, speed=3, restitution=0.5)
        for name, (start, end) in beds.items():
            text += box(name, [start, -0.03, -0.08], [end, 0.3, 0], fixed=True)
        low = [-0.08, -0.06, 0.001]
        text += box("block", low, np.add(low, SIZE), velocity=[0.0, 0.0, -SPEED])
        run = started(tmp_path, text)
        run.advance(0.01)
        found.append(np.concatenate([moving(run, "velocity")[0], moving(run, "spin")[0]]))
    assert abs(found[0][3]) > 1
    assert found[1] == pytest.approx(found[0], abs=1e-3)


def test_contacts_over_a_seam_are_restored_with_the_same_bits(tmp_path):
    text = head([0.0, -9.81], DP, speed=1)
    text += "".join(bed(2, name, *ends) for name, ends in two(0.09).items())
    text += box("block", [-0.08, 0.0], [0.08, 0.08], velocity=[1.0, 0.0])
    run = started(tmp_path, text)
    run.advance(0.05)
    assert_restored_with_the_same_bits(run, moving_bodies=1, until=0.1)


def test_a_block_lands_where_four_beds_meet(tmp_path):
    one = landed(tmp_path, 3, WHOLE)
    text = ""
    for name, x, y in (("a", -0.5, -0.5), ("b", 0.04, -0.5), ("c", -0.5, 0.03), ("d", 0.04, 0.03)):
        high = [0.04 if x < 0 else 0.5, 0.03 if y < 0 else 0.5, 0]
        text += box(name, [x, y, -0.08], high, fixed=True)
    text = head([0.0] * 3, DP, speed=3, restitution=0.5) + text
    text += box("block", [-0.08, -0.06, 0.001], [0.08, 0.06, 0.081], velocity=[0.0, 0.0, -SPEED])
    run = started(tmp_path, text)
    run.advance(0.01)
    assert_as_on_one((moving(run, "velocity")[0, 2], np.abs(moving(run, "spin")).max()), one)


def test_polygons_that_lie_flush_are_one_surface(tmp_path):
    one = landed(tmp_path, 2, WHOLE)
    left = [[-0.5, -0.1], [0.1, -0.1], [0.05, 0], [-0.5, 0]]
    right = [[0.1, -0.1], [0.5, -0.3], [0.5, 0], [0.05, 0]]
    text = head([0.0] * 2, DP, speed=3, restitution=0.5)
    text += body("left", "polygon", vertices=left, fixed=True)
    text += body("right", "polygon", vertices=right, fixed=True)
    text += box("block", [-0.08, 0.001], [0.08, 0.081], velocity=[0.0, -SPEED])
    run = started(tmp_path, text)
    run.advance(0.01)
    assert_as_on_one((moving(run, "velocity")[0, 1], np.abs(moving(run, "spin")).max()), one)


@pytest.mark.parametrize("dim", DIMS)
def test_beds_that_move_as_one_are_one(tmp_path, dim):
    """Up against the block; one that alone begins to move is a body of its own."""
    found = []
    for ways in ((1.0, 1.0), (1.0, 0.0)):
        text = head([0.0] * dim, DP, speed=3, restitution=0.5)
        for (name, ends), way in zip(two(0.05).items(), ways, strict=True):
            motion = f"{{ velocity = {[*[0.0] * (dim - 1), way]}, start = 0.0, stop = 0.01 }}"
            text += bed(dim, name, *ends, **({"motion": motion} if way else {}))
        low = [-0.08, *[-0.06] * (dim - 2), 0.002]
        text += box("block", low, np.add(low, SIZE if dim == 3 else SIZE[[0, 2]]))
        run = started(tmp_path, text)
        run.advance(0.01)
        found.append((moving(run, "velocity")[0, -1], np.abs(moving(run, "spin")).max()))
    assert found[0][1] < 1e-6
    assert found[0][0] == pytest.approx(1.5, abs=0.01)
    assert found[1][1] > 0.1


@pytest.mark.parametrize("dim", DIMS)
@pytest.mark.parametrize(
    "beds",
    [
        {"left": (-0.5, -0.06), "right": (0.02, 0.5)},  # apart
        {"left": (-0.5, 0.05, -DP), "right": (0.05, 0.5)},  # a step
        {"left": (-0.5, 0.05, -1e-4), "right": (0.05, 0.5)},  # a small one
    ],
)
def test_posts_and_steps_tip_a_block(tmp_path, dim, beds):
    assert landed(tmp_path, dim, beds)[1] > 0.1


@pytest.mark.parametrize("dim", DIMS)
def test_a_block_slides_over_seams_as_over_one_bed(tmp_path, dim):
    """Friction and what its points press go on from one bed to the next."""
    size, found = SIZE if dim == 3 else SIZE[[0, 2]], []
    for beds in (WHOLE, {"a": (-0.5, 0.1), "b": (0.1, 0.14), "c": (0.14, 0.5)}):
        text = head([0.0] * (dim - 1) + [-9.81], DP, speed=1)
        text += "".join(bed(dim, name, *ends) for name, ends in beds.items())
        low = [-size[0] / 2, *[-size[1] / 2] * (dim - 2), 0.0]
        text += box("block", low, np.add(low, size), velocity=[1.0, *[0.0] * (dim - 1)])
        run = started(tmp_path, text)
        run.advance(0.25)
        spin = np.abs(moving(run, "spin")).max()
        found.append(np.array([*moving(run, "centre")[0], *moving(run, "velocity")[0], spin]))
    assert found[0][0] > 0.15
    assert found[1] == pytest.approx(found[0], abs=2e-5)


def test_a_block_in_a_corner_of_flush_walls_lies_on_both(tmp_path):
    """Floor and wall have one outer side, and push each by itself."""
    text = head([3.0, -3.0], DP, speed=1, friction=0)
    text += box("floor", [-0.5, -0.08], [0.2, 0], fixed=True)
    text += box("end", [0.2, -0.08], [0.3, 0], fixed=True)
    text += box("wall", [0.2, 0.0], [0.3, 0.5], fixed=True)
    text += box("block", [0.04, 0.0], [0.2, 0.08])
    run = started(tmp_path, text)
    run.advance(0.2)
    assert np.abs(moving(run, "velocity")).max() < 1e-3
    assert moving(run, "centre")[0] == pytest.approx([0.12, 0.04], abs=1e-4)
    assert np.abs(moving(run, "spin")).max() < 1e-3
