"""Sides, edges and corners of a convex shape, however its faces are cut.  Lengths in m."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

FLAT = 1e-9  # of the size: below, points lie on one line or plane
BULGE = 1e-4  # of the size: by which a surface may miss being convex (files hold single precision)


class Outline(NamedTuple):
    """Faces of one plane are one side; edges lie between sides, in 2-D they are the sides."""

    area: np.ndarray  # (m, dim) of sides: outward normals times areas, in 2-D times lengths
    distance: np.ndarray  # (m,) of their planes from the origin
    edges: np.ndarray  # (k, 2, dim) ends

    @property
    def normal(self) -> np.ndarray:
        """Outward unit normals (m, dim) of the sides."""
        return self.area / np.linalg.norm(self.area, axis=1)[:, None]

    @property
    def middles(self) -> np.ndarray:
        """The middle (k, dim) of each edge."""
        return self.edges.mean(axis=1)

    @property
    def corners(self) -> np.ndarray:
        """The ends (n, dim) of the edges, each once."""
        ends = self.edges.reshape(-1, self.edges.shape[2])
        label = clusters(ends, BULGE * float(np.abs(ends).max()))
        return ends[np.unique(label, return_index=True)[1]]


def outline_of(vertices: np.ndarray, faces: np.ndarray) -> Outline:
    """The outline of a body with these faces (segments anticlockwise, or triangles outwards)."""
    corners = vertices[faces]
    area = _areas(corners)
    size = np.linalg.norm(area, axis=1)
    reach = float(np.linalg.norm(vertices, axis=1).max())
    volume = np.einsum("md,md->m", area, corners[:, 0])
    side = clusters(np.column_stack([area, volume / reach]) / size[:, None], BULGE)
    of_side = np.zeros((side.max() + 1, area.shape[1]))
    np.add.at(of_side, side, area)
    distance = np.bincount(side, volume) / np.linalg.norm(of_side, axis=1)
    return Outline(of_side, distance, _edges(vertices, faces, side))


def clusters(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Labels (N,) of points, the same for those nearer than `tolerance`; from 0 on in order."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    a, b = cKDTree(points).query_pairs(tolerance, output_type="ndarray").T
    links = coo_array((np.ones(len(a)), (a, b)), shape=(len(points), len(points)))
    return np.asarray(connected_components(links, directed=False)[1])


def _areas(corners: np.ndarray) -> np.ndarray:
    """Outward normals (m, dim) of faces (m, dim, dim) times their areas or lengths."""
    first = corners[:, 1] - corners[:, 0]
    if corners.shape[2] == 2:
        return np.stack([first[:, 1], -first[:, 0]], axis=1)
    return np.asarray(0.5 * np.cross(first, corners[:, 2] - corners[:, 0]))


def _edges(vertices: np.ndarray, faces: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Ends (k, 2, dim) of the edges, of however many pieces each consists."""
    pieces, sides = (faces, side[:, None]) if faces.shape[1] == 2 else _borders(faces, side)
    of = np.unique(sides, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(of, kind="stable")
    of_piece, corners = of[order], vertices[pieces[order]]
    first = np.flatnonzero(np.diff(of_piece, prepend=-1))
    along = (corners[first, 1] - corners[first, 0])[of_piece]
    ends, of_end = corners.reshape(-1, vertices.shape[1]), np.repeat(of_piece, 2)
    place = np.einsum("nd,nd->n", ends, np.repeat(along, 2, axis=0))
    lowest, highest = (np.lexsort((at, of_end))[2 * first] for at in (place, -place))
    return np.stack([ends[lowest], ends[highest]], axis=1)


def _borders(faces: np.ndarray, side: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edges of triangles between different sides: ends (k, 2) and the two sides (k, 2)."""
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    of_face = np.tile(side, 3)
    order = np.lexsort(ends.T)
    pairs, sides = ends[order][::2], np.sort(of_face[order].reshape(-1, 2), axis=1)
    between = sides[:, 0] != sides[:, 1]
    return pairs[between], sides[between]
