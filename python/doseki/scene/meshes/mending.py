"""Whether a mesh encloses something, and its triangles turned outwards where they are not."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...util.finding import Finding
from ..shapes import ShapeError, Triangles, core_mesh


@dataclass(frozen=True)
class TurnedTriangles(Finding):
    """A mesh some of whose triangles faced inwards."""

    count: int
    all: int

    def __str__(self) -> str:
        return (
            f"{self.place}: {self.count} of {self.all} triangles of its file faced inwards; they "
            "are taken as facing outwards"
        )


@dataclass(frozen=True)
class CutsItself(Finding):
    """A mesh that goes through itself."""

    count: int
    where: tuple[float, float, float]  # m, in the frame of the file

    def __str__(self) -> str:
        at = ", ".join(f"{x:.4g}" for x in self.where)
        return (
            f"{self.place}: its surface cuts itself {self.count} times, first at ({at}) m of its "
            "file; near there particles and normals may be wrong: unite its parts"
        )


def closed(file: Path, mesh: Triangles) -> Triangles:
    """The mesh with its triangles outwards; raises ShapeError where it is not closed."""
    _expect_closed(file, mesh)
    faces = mesh.faces
    if not _is_oriented(faces):
        faces = oriented(mesh)
        if not _is_oriented(faces):
            raise ShapeError(
                f"the surface in {file} has no inside and outside: more than two "
                "triangles meet at an edge, or it is one-sided"
            )
    found = Triangles(mesh.vertices, faces)
    return Triangles(mesh.vertices, _outwards(found))


def findings_of(place: str, before: Triangles, after: Triangles) -> list[Finding]:
    """What is to be said of a mesh as its file has it and as it was mended."""
    found: list[Finding] = []
    turned = int((before.areas * after.areas).sum(axis=1).__lt__(0).sum())
    if turned:
        found.append(TurnedTriangles(place, turned, len(after.faces)))
    count, *where = core_mesh(after, 0.0).cuts()
    if count:
        found.append(CutsItself(place, count, (where[0], where[1], where[2])))
    return found


def directed_edges(faces: np.ndarray) -> np.ndarray:
    """Edges (3 m, 2) of triangles, each from one corner to the next: all first ones, all second."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def _expect_closed(file: Path, mesh: Triangles) -> None:
    _, count = np.unique(np.sort(directed_edges(mesh.faces), axis=1), axis=0, return_counts=True)
    if open_edges := int((count % 2 == 1).sum()):
        raise ShapeError(
            f"the surface in {file} is not closed: {open_edges} edges have a triangle on one side "
            "only; mend it or, if it is meant to be open, set sheet = true"
        )


def _is_oriented(faces: np.ndarray) -> bool:
    """Whether each edge is passed as often in one direction as in the other."""
    edges = directed_edges(faces)
    forth = edges[:, 0] < edges[:, 1]
    _, which = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    return not np.bincount(which.ravel(), np.where(forth, 1.0, -1.0)).any()


def _neighbours(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of triangles (k,), (k,) that alone share an edge, and whether both pass it alike."""
    edges = directed_edges(faces)
    face = np.tile(np.arange(len(faces)), 3)
    _, which, count = np.unique(
        np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    order = np.argsort(which.ravel(), kind="stable")
    pairs = order[np.repeat(count == 2, count)].reshape(-1, 2)
    forth = edges[:, 0] < edges[:, 1]
    return face[pairs[:, 0]], face[pairs[:, 1]], forth[pairs[:, 0]] == forth[pairs[:, 1]]


def _graph(faces: np.ndarray, weight: np.ndarray) -> Any:
    """Neighbours as a graph, a `weight` (k,) above 0 for each of the pairs."""
    from scipy.sparse import coo_array

    first, second, _ = _neighbours(faces)
    return coo_array((weight, (first, second)), shape=(len(faces), len(faces))).tocsr()


def _parts(faces: np.ndarray) -> np.ndarray:
    """Label (m,) of the connected part of each triangle."""
    from scipy.sparse.csgraph import connected_components

    links = np.ones(len(_neighbours(faces)[0]))
    return np.asarray(connected_components(_graph(faces, links), directed=False)[1])


def oriented(mesh: Triangles) -> np.ndarray:
    """Faces that agree with their neighbours, where each edge has two."""
    from scipy.sparse.csgraph import breadth_first_order

    faces = mesh.faces
    first, second, alike = _neighbours(faces)
    graph = _graph(faces, np.arange(1.0, len(first) + 1))
    graph = graph + graph.T
    turned, seen = np.zeros(len(faces), bool), np.zeros(len(faces), bool)
    link = {(int(a), int(b)): bool(c) for a, b, c in zip(first, second, alike, strict=True)}
    for start in range(len(faces)):
        if seen[start]:
            continue
        order, before = breadth_first_order(graph, start, directed=False)
        seen[order] = True
        for k in order[1:]:
            pair = (int(before[k]), int(k))
            same = link[pair] if pair in link else link[pair[::-1]]
            turned[k] = turned[before[k]] != same
    result = faces.copy()
    result[turned] = result[turned][:, ::-1]
    return result


def _outwards(mesh: Triangles) -> np.ndarray:
    """Faces of which each connected part encloses a volume above 0, but for hollows in others."""
    label = _parts(mesh.faces)
    corners = mesh.corners - mesh.vertices.mean(axis=0)
    volume = np.bincount(label, np.linalg.det(corners) / 6)
    faces = mesh.faces.copy()
    for part in np.flatnonzero(volume < 0):
        others = Triangles(mesh.vertices, mesh.faces[label != part])
        probe = mesh.corners[label == part][:1].mean(axis=1)
        is_hollow = len(others.faces) and core_mesh(others, 0.0).winding(probe)[0] % 2 != 0
        if not is_hollow:
            faces[label == part] = faces[label == part][:, ::-1]
    return faces
