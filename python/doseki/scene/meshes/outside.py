"""The triangles between a mesh and what is around it: its own, or the outside of a sheet."""

from __future__ import annotations

import numpy as np

from ..shapes import MeshShape, Triangles
from .mending import directed_edges, oriented

FLAT = 0.02  # of the largest stretch of normals about a vertex; less is no direction of its own
LONGEST = 2.0  # half thicknesses between a vertex and the outside of a sheet


def outside_of(shape: MeshShape) -> np.ndarray:
    """Corners (n, 3, 3), m, of triangles that enclose a mesh, anticlockwise from outside.

    Those of a closed mesh are its own.  Of a sheet they lie on both sides and along its rims.
    """
    mesh = shape.mesh
    if not shape.thickness:
        return mesh.corners
    faces = oriented(mesh)
    way = 0.5 * shape.thickness * _ways(Triangles(mesh.vertices, faces))
    front, back = mesh.vertices + way, mesh.vertices - way
    a, b = _rims(faces).T
    strips = [
        np.stack([front[b], front[a], back[a]], axis=1),
        np.stack([front[b], back[a], back[b]], axis=1),
    ]
    return np.concatenate([front[faces], back[faces[:, ::-1]], *strips])


def _ways(mesh: Triangles) -> np.ndarray:
    """From each vertex (n, 3) to where the planes of its triangles meet, if each goes out by 1."""
    area = mesh.areas
    size = np.linalg.norm(area, axis=1)[:, None]
    normal = area / size
    total, square = np.zeros_like(mesh.vertices), np.zeros((len(mesh.vertices), 3, 3))
    for corner in mesh.faces.T:
        np.add.at(total, corner, area)
        np.add.at(square, corner, normal[:, :, None] * area[:, None, :])
    way = np.einsum("nij,nj->ni", np.linalg.pinv(square, rcond=FLAT, hermitian=True), total)
    length = np.maximum(np.linalg.norm(way, axis=1), 1e-300)
    return np.asarray(way * np.minimum(1.0, LONGEST / length)[:, None])


def _rims(faces: np.ndarray) -> np.ndarray:
    """Edges (k, 2) that no triangle passes the other way, as often as they are passed."""
    edges = directed_edges(faces)
    forth = edges[:, 0] < edges[:, 1]
    _, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    sign = np.where(forth, 1, -1)
    balance = sign * np.bincount(which.ravel(), sign)[which.ravel()]
    kept = np.flatnonzero(balance > 0)
    _, first = np.unique(which.ravel()[kept], return_index=True)
    once = kept[first]
    return np.asarray(np.repeat(edges[once], balance[once].astype(int), axis=0))
