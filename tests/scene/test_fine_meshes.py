"""Convex bodies whose surface has many faces."""

from __future__ import annotations

import time

import numpy as np
import pytest
import trimesh

from doseki.scene.shapes import ShapeError, mesh_shape
from doseki.scene.shapes.outline import outline_of

SPHERE = trimesh.creation.uv_sphere(radius=0.1, count=[180, 180])


def test_the_edges_of_a_surface_of_many_faces_are_found_at_once():
    begun = time.perf_counter()
    outline = outline_of(np.array(SPHERE.vertices), np.array(SPHERE.faces))
    assert time.perf_counter() - begun < 5.0
    lengths = np.linalg.norm(outline.edges[:, 1] - outline.edges[:, 0], axis=1)
    assert len(outline.edges) > 50_000
    assert 0 < lengths.min() <= lengths.max() < 0.01


def test_an_edge_of_many_pieces_is_one():
    box = trimesh.creation.box((1, 2, 3)).subdivide().subdivide()
    turned = np.random.default_rng(0).permutation(len(box.faces))
    outline = outline_of(np.array(box.vertices), np.array(box.faces)[turned])
    lengths = np.linalg.norm(outline.edges[:, 1] - outline.edges[:, 0], axis=1)
    assert sorted(lengths.round(9)) == [1] * 4 + [2] * 4 + [3] * 4


def test_a_convex_body_of_too_many_sides_is_refused_with_their_number(tmp_path):
    SPHERE.export(tmp_path / "ball.stl")
    with pytest.raises(ShapeError, match=r'at most 10000 are taken.*shape = "mesh"'):
        mesh_shape(tmp_path / "ball.stl", 1.0)
