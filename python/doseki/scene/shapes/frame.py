"""The frame of a convex shape: axes that turn with it and share its symmetries.  Lengths in m."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np

SAME = 1e-4  # of the size: what lies so near to a place is there
RIGHT = 1e-6  # cosine of what counts as a right angle
MANY = 12  # sides, corners and edges each that are looked at


def own_frame(corners: np.ndarray, sides: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """The axes as columns of a matrix (dim, dim).

    `corners` (n, dim) about the centre of mass, `sides` (m, dim) outward normals times areas,
    `middles` (k, dim) of the edges.  Axes of symmetry pass through these.  The frame is the one in
    which most symmetries of the square or cube are symmetries of the shape; of several the one
    along which most of its surface lies. Order and signs are those nearest to the given axes.
    """
    frames = _frames(_directions(corners, sides, middles))
    merit = [(_symmetries(corners, axes), _aligned(sides, axes)) for axes in frames]
    same = frames[merit.index(max(merit))] @ signed_permutations(corners.shape[1])
    return np.asarray(same[np.trace(same, axis1=1, axis2=2).argmax()])


def signed_permutations(dim: int) -> np.ndarray:
    """The symmetries (8 or 48, dim, dim) of the square or the cube."""
    signs = list(product((1.0, -1.0), repeat=dim))
    turns = [np.eye(dim)[list(order)] for order in permutations(range(dim))]
    return np.array([turn * sign for turn in turns for sign in signs])


def _directions(corners: np.ndarray, sides: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Unit vectors along which axes may lie; principal axes where no others are at right angles."""
    area = np.linalg.norm(sides, axis=1)
    largest = np.argsort(-np.round(area / area.max(), 6), kind="stable")
    principal = np.linalg.eigh(corners.T @ corners)[1].T
    found = np.concatenate([sides[largest[:MANY]], corners[:MANY], middles[:MANY], principal])
    length = np.linalg.norm(found, axis=1)
    kept = length > SAME * length.max()
    return found[kept] / length[kept, None]


def _frames(unit: np.ndarray) -> list[np.ndarray]:
    if unit.shape[1] == 2:
        return [np.array([[x, -y], [y, x]]) for x, y in unit]
    first, second = np.nonzero(np.triu(np.abs(unit @ unit.T) < RIGHT))
    return [_right_handed(unit[i], unit[j]) for i, j in zip(first, second, strict=True)]


def _right_handed(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    v = v - (u @ v) * u
    v = v / np.linalg.norm(v)
    return np.stack([u, v, np.cross(u, v)], axis=1)


def _symmetries(corners: np.ndarray, axes: np.ndarray) -> int:
    """How many of the square or cube along `axes` map the corners onto one another."""
    from scipy.spatial import cKDTree

    upright = corners @ axes
    tree, limit = cKDTree(upright), SAME * float(np.abs(upright).max())
    moves = signed_permutations(corners.shape[1])
    some = tree.query(upright[:MANY] @ moves)[0].max(axis=1) < limit
    return int((tree.query(upright @ moves[some])[0].max(axis=1) < limit).sum())


def _aligned(sides: np.ndarray, axes: np.ndarray) -> float:
    """Share of the surface that lies along the axes."""
    area = np.linalg.norm(sides, axis=1)
    along = np.abs(sides @ axes).max(axis=1) > (1 - RIGHT) * area
    return round(float(area[along].sum() / area.sum()), 6)
