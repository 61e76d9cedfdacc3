"""Elastic discs: an even load gives an even stress, in the middle as well."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from doseki.scene.shapes import Ball

RADIUS = 0.1


def bent_hexagons(number):
    """Rings of 6, 12, 18 ... points as they are before they are balanced."""
    spacing = RADIUS * np.sqrt(np.pi / (3 * number * (number + 1) + 1))
    points = [np.zeros((1, 2))]
    for k in range(1, number + 1):
        angle = np.pi / 3 * np.arange(6 * k) / k
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        points.append(k / number * (RADIUS - 0.5 * spacing) * ring)
    return np.concatenate(points)


def balanced(number):
    """The rings of a body."""
    return Ball(RADIUS, 2).elastic_particles(RADIUS / number).position


def spacing_of(position):
    """From the area of each."""
    return RADIUS * np.sqrt(np.pi / len(position))


def outermost(position):
    """Whether points are on the last ring."""
    distance = np.linalg.norm(position, axis=1)
    return distance > distance.max() - 1e-9


def pressed(position):
    """Even tension on the circle; its places go with the points below, as those of contacts do."""
    support, count = 1.6 * spacing_of(position), outermost(position).sum()
    force = np.zeros_like(position)
    for k in np.flatnonzero(outermost(position)):
        R = position[k] - position
        weight = np.maximum(1 - np.linalg.norm(R, axis=1) / support, 0) ** 3
        normal = position[k] / np.linalg.norm(position[k])
        along = np.linalg.solve(np.einsum("n,ni,nj->ij", weight, R, R), normal)
        share = weight * (R @ along) * 0.5 * spacing_of(position)
        traction = 2 * np.pi * RADIUS / count * normal
        force -= share[:, None] * traction
        force[k] += (1 + share.sum()) * traction
    return force


def squeezed(elastic, position):
    """Mean and deviatoric stress over a pressure from all around, at rest."""
    bodies = elastic((position, np.zeros_like(position)), spacing=spacing_of(position), damping=0.5)
    bodies.set_load(-10.0 * pressed(position))
    bodies.advance(0.5)
    P = bodies.state()["stress"]
    mean = 0.5 * (P[:, 0, 0] + P[:, 1, 1])
    deviator = np.hypot(0.5 * (P[:, 0, 0] - P[:, 1, 1]), 0.5 * (P[:, 0, 1] + P[:, 1, 0]))
    return mean / -10.0, deviator / 10.0


@pytest.mark.parametrize("number", [5, 10, 15])
def test_no_point_of_a_squeezed_disc_reads_more_than_5_percent_off(elastic, number):
    mean, deviator = squeezed(elastic, balanced(number))
    assert np.abs(mean - 1).max() < 0.05
    assert deviator.max() < 0.05
    assert mean[0] == pytest.approx(1, abs=0.03)  # in the middle


def test_bent_hexagons_read_half_in_the_middle(elastic):
    mean, _ = squeezed(elastic, bent_hexagons(5))
    assert mean[0] < 0.55


@pytest.mark.parametrize("number", [4, 7, 10, 16])
def test_an_even_stress_is_in_balance(elastic, number):
    """A stretched disc accelerates in its two outermost rings alone: the surface has no load."""
    stretch = np.array([[0.01, 0.003], [0.0, -0.005]])
    felt = []
    for position in (balanced(number), bent_hexagons(number)):
        strained = position @ stretch.T
        spacing = spacing_of(position)
        bodies = elastic(
            (position + strained, 0 * position), spacing=spacing, displacement=strained
        )
        size = np.linalg.norm(bodies.state()["acceleration"], axis=1)
        inside = np.linalg.norm(position, axis=1) < RADIUS - 2 * spacing
        felt.append(size[inside].max() / size.max())
    assert felt[0] < 0.05
    assert felt[1] > 0.3


@pytest.mark.parametrize("number", [1, 4, 7, 11])
def test_a_disc_has_the_symmetries_of_the_hexagon(number):
    position = balanced(number)
    tree, angle = cKDTree(position), np.pi / 3
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for image in (position @ turn.T, position * [1, -1], position * [-1, 1]):
        assert tree.query(image)[0].max() < 1e-13
    last = position[outermost(position)]
    assert len(last) == 6 * number
    np.testing.assert_allclose(
        np.linalg.norm(last, axis=1), RADIUS - 0.5 * spacing_of(position), rtol=1e-12
    )
