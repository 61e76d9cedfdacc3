"""Particles of a shape, and the way out of it from each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

EDGE = 0.1  # dp: what is farther from one face than from another by less lies along their edge
ALIKE = 1e-6  # of a depth: faces that differ by less are as near
SMOOTH = 0.64  # cosine of 50 degrees, by which normals beside an edge differ at least
CANCEL = 1e-6  # the mean of normals that is shorter has no direction


class Edges(NamedTuple):
    """The faces nearest to particles of a wall, at most `dim`; zero where it has no edge."""

    normals: np.ndarray  # (N, dim, dim), in rows, outwards
    depths: np.ndarray  # (N, dim) below them, m


class Particles(NamedTuple):
    """Particles of a shape; those midway between opposite sides have no normal: zero."""

    position: np.ndarray  # (N, dim), m
    normal: np.ndarray  # (N, dim) outwards
    depth: np.ndarray  # (N,) below the surface, m
    curvature: np.ndarray  # (N,) of the surface, 1/m, alike all ways; 0 where it is plane
    share: np.ndarray  # (N,) of the mass
    edges: Edges


class Curve(NamedTuple):
    """What controls the uniform cubic B-spline that is the surface of a shape in 2-D."""

    vertex: np.ndarray  # (n, 2) anticlockwise, m
    crease: np.ndarray  # (n,) bool: corners


def alike(number: int) -> np.ndarray:
    """Equal shares of so many particles."""
    return np.full(number, 1.0 / number)


def from_centre(
    position: np.ndarray, radius: float, share: np.ndarray, curvature: float = 0.0
) -> Particles:
    """Particles of a ball about the origin, whose surface has a curvature, 1/m."""
    distance = np.linalg.norm(position, axis=1)
    normal = position / np.maximum(distance, 1e-300)[:, None]
    alike = np.full(len(position), curvature)
    none = no_edges(*position.shape)
    return Particles(position, normal, radius - distance, alike, share, none)


def nearest_faces(
    gaps: np.ndarray, normals: np.ndarray, width: float
) -> tuple[np.ndarray, np.ndarray]:
    """Normal (N, dim) and depth (N,) below the nearest of faces.

    `gaps` (N, m) to the faces, infinite for those that do not count, `normals` (m, dim) of them.
    Those that are as near count as much: along an edge the normal is the mean of two, in a corner
    of three.  One that is farther by `width` counts no more.
    """
    return _mean(_nearness(gaps, width), normals), gaps.min(axis=1)


def beside_edges(gaps: np.ndarray, normals: np.ndarray, width: float) -> Edges:
    """The nearest faces, as in `nearest_faces`; zero where there is but one.

    Faces that lean to each other by less than an edge does are a smooth surface, as that of a
    boulder is; the mean of those that are as near stands for it.  Of faces that are as near none is
    chosen where there is no room for all of them.
    """
    rows, dim = len(gaps), normals.shape[1]
    edges, most = no_edges(rows, dim), min(dim, len(normals))
    order = np.argsort(gaps, axis=1, kind="stable")
    smooth = normals[order[:, 0]] @ normals.T > SMOOTH
    found = np.zeros((rows, most + 1, dim))
    found[:, 0] = _mean(_nearness(gaps, width) * smooth, normals)
    depths = np.full((rows, most + 1), np.inf)
    depths[:, 0] = gaps.min(axis=1)
    number = np.ones(rows, int)
    for face in order[:, 1:].T:
        lean = np.einsum("nkd,nd->nk", found, normals[face])
        there = (number <= most) & np.isfinite(gaps[np.arange(rows), face])
        new = np.flatnonzero((lean.max(axis=1) < SMOOTH) & there)
        found[new, number[new]] = normals[face[new]]
        depths[new, number[new]] = gaps[new, face[new]]
        number[new] += 1
        if (number > most).all():
            break
    chosen = depths[:, :most] < (depths[:, most] * (1 - ALIKE))[:, None]
    chosen &= (number > 1)[:, None] & np.isfinite(depths[:, :most])
    edges.normals[:, :most] = np.where(chosen[..., None], found[:, :most], 0.0)
    edges.depths[:, :most] = np.where(chosen, depths[:, :most], 0.0)
    return edges


def _nearness(gaps: np.ndarray, width: float) -> np.ndarray:
    """Weights (N, m) of faces: 1 for the nearest, 0 for one that is farther by `width`."""
    return np.maximum(1 - (gaps - gaps.min(axis=1)[:, None]) / width, 0)


def _mean(weight: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Unit vectors (N, dim) along weighted sums of normals; zero where these cancel."""
    total = weight @ normals
    length = np.linalg.norm(total, axis=1)
    outwards = length > CANCEL * weight.sum(axis=1)
    unit = total / np.where(outwards, length, 1.0)[:, None]
    return np.where(outwards[:, None], unit, 0.0)


def no_edges(rows: int, dim: int) -> Edges:
    """Of walls without edges, or whose edges are not known."""
    return Edges(np.zeros((rows, dim, dim)), np.zeros((rows, dim)))
