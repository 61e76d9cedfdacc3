"""Particles of a wall of triangles: a layer below its surface.  Lengths in m.

They are points of a cubic lattice that lies along the faces that have most of the surface. Below
faces that are slanted to it, or curved, they are shifted until they are evenly spaced and the
surface is half a spacing above them.
"""

from __future__ import annotations

import numpy as np

from ..shapes import MeshShape, Triangles
from ..shapes.mesh_edges import sharp_edges
from .evening import evened

PARALLEL = 1e-6  # 1 - cosine of what counts as parallel, cosine of what counts as a right angle
BLOCK = 4  # lattice points along each side of a block
ON_FACE = 1e-6  # dp: what is no deeper is outside
SAME_PLACE = 0.02  # dp: two faces so near are at one place of the lattice
MANY = 12  # faces whose directions are looked at


def layer_count(shape: MeshShape, dp: float, depth: float) -> float:
    """How many particles a wall of that depth has, or nearly."""
    return min(shape.area * depth, max(shape.measure, shape.area * dp)) / dp**3


def wall_layer(shape: MeshShape, dp: float, depth: float) -> np.ndarray:
    """Positions (N, 3) no deeper than `depth` below the surface, each of which stands for dp^3."""
    axes = lattice_axes(shape.mesh)
    origin = _origin(shape, axes, dp)
    position = _lattice_near(shape, axes, origin, dp, depth)
    below = shape.wall(position, dp)[1]
    kept = (below > ON_FACE * dp) & (below < depth - ON_FACE * dp)
    if not shape.thickness:
        kept &= shape.contains(position)
    return evened(shape, position[kept], dp, depth)


def lattice_axes(mesh: Triangles) -> np.ndarray:
    """Columns (3, 3): the normal with most of the surface, one at a right angle with most of that.

    Where no face is at a right angle to the first, the longest sharp edge or rim that lies in it.
    """
    area = mesh.areas
    size = np.linalg.norm(area, axis=1)
    normal = area / size[:, None]
    first = _best(normal, normal, size)
    across = np.abs(normal @ first) < PARALLEL
    if across.any():
        second = _best(normal[across], normal[across], size[across])
    else:
        start, end = mesh.vertices[sharp_edges(mesh.vertices, mesh.faces).T]
        side = end - start
        length = np.linalg.norm(side, axis=1)
        flat = np.abs(side @ first) < 1e-4 * length
        axis = np.eye(3)[np.abs(first).argmin()]
        second = side[flat][length[flat].argmax()] if flat.any() else axis
    second = second - (second @ first) * first
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)], axis=1)


def _best(candidates: np.ndarray, normal: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Of the candidates of the largest triangles that along which most of the surface faces."""
    largest = np.argsort(-np.round(size / size.max(), 6), kind="stable")[:MANY]
    along = np.abs(candidates[largest] @ normal.T) > 1 - PARALLEL
    return np.asarray(candidates[largest][(along * size).sum(axis=1).round(12).argmax()])


def _origin(shape: MeshShape, axes: np.ndarray, dp: float) -> np.ndarray:
    """A corner (3,) of the lattice's cells, in the frame of the axes.

    Along each axis as much of the faces as can be lies between two layers; with none, the middle
    of the extent is as far from both ends.
    """
    area = shape.mesh.areas
    size = np.linalg.norm(area, axis=1)
    middle = shape.mesh.corners.mean(axis=1) @ axes
    facing = (area / size[:, None]) @ axes
    origin = np.zeros(3)
    for a in range(3):
        flat = np.abs(facing[:, a]) > 1 - PARALLEL
        place = middle[flat, a] + np.sign(facing[flat, a]) * 0.5 * shape.thickness
        if flat.any():
            origin[a] = _most(place / dp % 1.0, size[flat]) * dp
            continue
        ends = shape.mesh.vertices @ axes[:, a]
        low, extent = ends.min() - 0.5 * shape.thickness, np.ptp(ends) + shape.thickness
        origin[a] = low + 0.5 * (extent - max(np.rint(extent / dp), 1) * dp)
    return origin


def _most(place: np.ndarray, weight: np.ndarray) -> float:
    """The place on a circle of length 1 near which most of the weight is."""
    near = (
        np.abs((place[:, None] - place[None, :] + 0.5) % 1.0 - 0.5) < SAME_PLACE
        if len(place) <= 2000
        else None
    )
    if near is None:  # so many faces: by bins
        bins = np.bincount((place / SAME_PLACE).astype(int), weight)
        return float(place[(place / SAME_PLACE).astype(int) == bins.argmax()][0])
    return float(place[(near @ weight).round(12).argmax()])


def _lattice_near(
    shape: MeshShape, axes: np.ndarray, origin: np.ndarray, dp: float, depth: float
) -> np.ndarray:
    """Lattice points in blocks that may hold some no deeper than `depth`."""
    ends = shape.mesh.vertices @ axes
    low = np.floor((ends.min(axis=0) - shape.thickness - origin) / dp).astype(np.int64) - 1
    extent = np.ceil((ends.max(axis=0) + shape.thickness - origin) / dp).astype(np.int64) + 1 - low
    side = BLOCK
    while side < extent.max():
        side *= 2
    corners = low[None, :]
    halves = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
    while side > BLOCK:
        side //= 2
        corners = (corners[:, None, :] + side * halves).reshape(-1, 3)
        centre = (origin + (corners + 0.5 * side) * dp) @ axes.T
        below = shape.wall(centre, dp)[1]
        around = 0.5 * np.sqrt(3) * side * dp
        corners = corners[(below > -around) & (below < depth + around)]
    steps = np.arange(BLOCK)
    inner = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = (corners[:, None, :] + inner).reshape(-1, 3)
    return np.asarray((origin + (cells + 0.5) * dp) @ axes.T)
