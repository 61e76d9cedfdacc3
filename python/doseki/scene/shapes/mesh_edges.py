"""Points on the edges of a mesh that stick out: where it touches the flat side of a body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

FLAT = 0.01  # sine of the angle below which two triangles are one face
AROUND_RIM = np.radians([-90, -45, 0, 45, 90])  # where a sheet's rim is touched


class Edges(NamedTuple):
    """Edges of triangles, each once: ends, and on either side a normal and the other corner."""

    ends: np.ndarray  # (k, 2) vertices
    normal: np.ndarray  # (k, 2, 3); the second is zero at a rim
    other: np.ndarray  # (k, 2) vertices; the second is -1 at a rim


def edge_points(vertices: np.ndarray, faces: np.ndarray, thickness: float, dp: float) -> np.ndarray:
    """Points (n, 3) along convex edges and rims no farther apart than dp, m; at most two in a cell.

    Of a sheet they lie on its outer surfaces and around its rims.  Where the flat side of a convex
    body meets the mesh with none of its own corners or edges, there is one of these.
    """
    edges = _edges(vertices, faces)
    if thickness:
        found = [
            *_of_folds(vertices, edges, thickness, dp),
            *_of_rims(vertices, edges, thickness, dp),
        ]
    else:
        found = [_along(vertices, edges.ends[_bends(vertices, edges) < -FLAT], dp)]
    points = np.concatenate([np.zeros((0, 3)), *found])
    cell = np.floor(points / (0.5 * dp) + 1e-6).astype(np.int64)
    _, first = np.unique(cell, axis=0, return_index=True)
    return np.asarray(points[np.sort(first)])


def sharp_edges(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The ends (k, 2) of rims and of edges at which the surface bends either way."""
    edges = _edges(vertices, faces)
    return np.asarray(edges.ends[np.abs(_bends(vertices, edges)) > FLAT])


def _edges(vertices: np.ndarray, faces: np.ndarray) -> Edges:
    """Of edges at which more than two triangles meet, the first two."""
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    other = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    face = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((face, ends[:, 1], ends[:, 0]))
    ends, other, face = ends[order], other[order], face[order]
    new = np.append(True, (np.diff(ends, axis=0) != 0).any(axis=1))
    first = np.flatnonzero(new)
    count = np.diff(np.append(first, len(ends)))
    second = np.minimum(first + 1, len(ends) - 1)
    double = count > 1
    normals = np.stack([normal[face[first]], normal[face[second]] * double[:, None]], axis=1)
    others = np.stack([other[first], np.where(double, other[second], -1)], axis=1)
    return Edges(ends[first], normals, others)


def _bends(vertices: np.ndarray, edges: Edges) -> np.ndarray:
    """Sine (k,) by which the second triangle rises over the first: below 0 an edge sticks out.

    Infinite at rims.
    """
    start, end = vertices[edges.ends[:, 0]], vertices[edges.ends[:, 1]]
    along = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
    arm = vertices[edges.other[:, 1]] - start
    arm -= (arm * along).sum(axis=1)[:, None] * along
    length = np.maximum(np.linalg.norm(arm, axis=1), 1e-300)
    rise = (arm * edges.normal[:, 0]).sum(axis=1) / length
    return np.where(edges.other[:, 1] < 0, np.inf, rise)


def _along(
    vertices: np.ndarray, ends: np.ndarray, dp: float, shift: np.ndarray | float = 0.0
) -> np.ndarray:
    """The ends, then points in between; `shift` (k, 3) is added to those of each edge."""
    start, end = vertices[ends[:, 0]] + shift, vertices[ends[:, 1]] + shift
    parts = np.ceil(np.linalg.norm(end - start, axis=1) / dp * (1 - 1e-4)).astype(np.int64)
    inner = np.maximum(parts - 1, 0)
    edge = np.repeat(np.arange(len(ends)), inner)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(inner) - inner, inner) + 1
    share = (number / parts[edge])[:, None]
    return np.concatenate([start, end, start[edge] + share * (end - start)[edge]])


def _of_folds(vertices: np.ndarray, edges: Edges, thickness: float, dp: float) -> list[np.ndarray]:
    """On the outer side of edges at which a sheet is bent."""
    bend = _bends(vertices, edges)
    folded = np.isfinite(bend) & (np.abs(bend) > FLAT)
    # Neighbours may face different ways: the second one's normal is what the bend makes of it.
    first, second = np.moveaxis(edges.normal[folded], 1, 0)
    second = np.where(((first * second).sum(axis=1) < 0)[:, None], -second, second)
    out = -np.sign(bend[folded])[:, None] * (first + second)
    out /= np.maximum(np.linalg.norm(out, axis=1), 1e-300)[:, None]
    return [_along(vertices, edges.ends[folded], dp, 0.5 * thickness * out)]


def _of_rims(vertices: np.ndarray, edges: Edges, thickness: float, dp: float) -> list[np.ndarray]:
    rim = edges.other[:, 1] < 0
    ends, normal = edges.ends[rim], edges.normal[rim, 0]
    side = vertices[ends[:, 1]] - vertices[ends[:, 0]]
    out = np.cross(side, normal)
    out /= np.maximum(np.linalg.norm(out, axis=1), 1e-300)[:, None]
    inwards = vertices[edges.other[rim, 0]] - vertices[ends[:, 0]]
    out *= -np.sign((out * inwards).sum(axis=1))[:, None]
    return [
        _along(vertices, ends, dp, 0.5 * thickness * (np.cos(t) * out + np.sin(t) * normal))
        for t in AROUND_RIM
    ]
