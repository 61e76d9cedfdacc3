"""Films that slide off a plate fly straight on, Eqs. (148) and (149)."""

from __future__ import annotations

import numpy as np
import pytest

from ..flows import Flows

# A film of `rows` particles on a plate that ends at the origin; there is no gravity. All is turned
# by `turn` degrees about the last axis, in 3-D the plate is periodic in z.
FILM = """\
dim = {dim}
scheme = "resolved"
speed_max = 2
dp = 0.01
time_max = 1
time_out = 1
gravity = {gravity}
{domain}

[parameters]
turn = {{ value = {turn} }}
c = {{ value = "= cos(radians(turn))" }}
s = {{ value = "= sin(radians(turn))" }}

[body.plate]
material = "aluminium"
fixed = true
wall = "free_slip"
shape = "box"
min = {plate[0]}
max = {plate[1]}
rotate = "= turn"
pivot = {pivot}

[body.film]
shape = "box"
material = "water"
min = {film[0]}
max = {film[1]}
rotate = "= turn"
pivot = {pivot}
velocity = {velocity}
"""
DP, LONG, WIDE, SPEED = 0.01, 0.2, 0.07, 2.0  # m, m/s
PERIODIC = f'periodic = ["z"]\ndomain_min = [-9, -9, 0]\ndomain_max = [9, 9, {WIDE}]'


def box(low, high, dim, sign):
    """Both corners; a `sign` of -1 mirrors it."""
    ends = sorted((sign * low[0], sign * high[0]))
    depth = ([0.0], [WIDE]) if dim == 3 else ([], [])
    return [ends[0], low[1], *depth[0]], [ends[1], high[1], *depth[1]]


def film(dim: int, rows: int, turn: float, sign: int, thick: float) -> str:
    """The scenario, a film that moves to +x, or to -x for a `sign` of -1."""
    rest = [0] * (dim - 2)
    return FILM.format(
        dim=dim,
        gravity=[0, 0, *rest],
        pivot=[0, 0, *rest],
        domain=PERIODIC if dim == 3 else "",
        turn=turn,
        plate=box((-0.4, -thick), (0.0, 0.0), dim, sign),
        film=box((-LONG - 0.05, 0.0), (-0.05, rows * DP), dim, sign),
        velocity=[f"= {sign * SPEED}*c", f"= {sign * SPEED}*s", *rest],
    )


def final_velocity(simulation):
    """Mean of what moves, once the film has left the plate."""
    simulation.advance(limit=0.2, pause=0.2, max_steps=10**6)
    velocity = simulation.state()["velocity"][:, :2]
    return velocity[np.linalg.norm(velocity, axis=1) > 0.1 * SPEED].mean(axis=0)


POLYGON = """
shape = "polygon"
vertices = [[0, 0], [-0.4, 0], [-0.4, -0.1], [{foot}, -0.1]]
"""
BOX = """
shape = "box"
min = [-0.4, -0.1]
max = [0.0, 0.0]
"""


@pytest.mark.parametrize("rows", [2, 6])
@pytest.mark.parametrize("foot", [-0.06, 0.0, 0.06])
def test_past_any_corner_of_a_polygon(tmp_path, foot, rows):
    """Corners of 60, 90 and 120 degrees."""
    text = film(2, rows, 0.0, 1, 0.1)
    assert BOX in text
    simulation = Flows(tmp_path)(text.replace(BOX, POLYGON.format(foot=foot)))
    velocity = final_velocity(simulation)
    assert velocity[0] > 0.98 * SPEED
    assert abs(velocity[1]) < 0.02 * SPEED


@pytest.mark.parametrize(
    ("dim", "turn", "sign"), [(2, 0.0, 1), (2, 0.0, -1), (2, 30.0, 1), (3, 0.0, 1)]
)
@pytest.mark.parametrize("thick", [0.04, 0.1])  # of the plate: one wet face, and all of them
@pytest.mark.parametrize("rows", [1, 2, 3, 6])
def test_a_film_that_leaves_a_plate_flies_straight_on(tmp_path, dim, turn, sign, thick, rows):
    simulation = Flows(tmp_path)(film(dim, rows, turn, sign, thick))
    velocity = final_velocity(simulation)
    angle = np.radians(turn)
    along = velocity @ np.array([sign * np.cos(angle), sign * np.sin(angle)])
    across = velocity @ np.array([-np.sin(angle), np.cos(angle)])
    assert along > 0.98 * SPEED
    assert abs(across) < 0.02 * SPEED  # a tenth where edges of walls hold water by suction
