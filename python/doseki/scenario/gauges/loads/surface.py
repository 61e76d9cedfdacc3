"""The surface of fixed bodies in pieces: their faces cut small, or the first row of particles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....record.particles import FIXED
from ..gauge import Sampled, Setting, State

PARTS = 4  # along each side of a piece, by which what other walls leave of it is counted
EDGE_REACH, LIKE, UNLIKE, EVEN = 1.5, 0.9, 0.5, 0.3  # neighbours and their normals at an edge

Box = tuple[np.ndarray, np.ndarray]  # lower and upper corner, m


@dataclass(frozen=True)
class Elements:
    """n pieces of the surface of bodies, none larger than a particle."""

    place: np.ndarray  # (n, dim) the middle of each, m
    area: np.ndarray  # (n, dim) outwards, m2; 2-D: m
    parts: np.ndarray  # (n, p, dim) the middles of parts of the same area, m
    body: np.ndarray  # (n,) which it is of

    @property
    def normal(self) -> np.ndarray:
        """Unit vectors (n, dim) outwards."""
        size = np.linalg.norm(self.area, axis=1)
        return np.asarray(self.area / np.maximum(size, 1e-300)[:, None])


def surface_of(run: Sampled, setting: Setting, bodies: Sequence[str], box: Box) -> Elements:
    """The surface of the fixed bodies of some tables, which lie within a box.

    Of a body that has faces these are cut; of others each particle of the first row stands for a
    piece.  A body that has no particles there has vanished.
    """
    state = run.sample(list(box[0]), list(box[1]))
    fixed = (state["motion"] == FIXED) & setting.is_of_bodies(bodies, state)
    faced = [name for name in bodies if name in setting.faces]
    there = set(np.unique(state["body"][fixed]).tolist())
    found = [_of_faces(run, setting, name) for name in faced]
    of_faces = setting.is_of_bodies(faced, state)
    row = _first_row(state, fixed & ~of_faces, setting.dp)
    pieces = [one for one in found if set(one.body.tolist()) <= there]
    return _joined([_of_particles(state, row, setting.dp), *pieces])


def _joined(found: Sequence[Elements]) -> Elements:
    columns = ((one.place, one.area, one.parts, one.body) for one in found)
    return Elements(*(np.concatenate(column) for column in zip(*columns, strict=True)))


def _of_faces(run: Sampled, setting: Setting, name: str) -> Elements:
    """The faces of a table, which come cut into pieces."""
    corners = setting.faces[name](run.time)
    dim = setting.dim
    if dim == 2:
        along = corners[:, 1] - corners[:, 0]
        area = np.stack([along[:, 1], -along[:, 0]], axis=1)
    else:
        sides = corners[:, 1:] - corners[:, :1]
        area = 0.5 * np.cross(sides[:, 0], sides[:, 1])
    parts = np.einsum("pc,nca->npa", _SHARES[dim], corners)
    (body,) = setting.bodies_of([name])
    of = np.full(len(corners), setting.body_names.index(body))
    return Elements(corners.mean(axis=1), area, parts, of)


def _halved() -> np.ndarray:
    """Where the middles of PARTS equal lengths of a line lie, as shares (p, 2) of its ends."""
    along = (np.arange(PARTS) + 0.5) / PARTS
    return np.stack([1 - along, along], axis=1)


def _quartered() -> np.ndarray:
    """Where the middles of PARTS^2 like parts of a triangle lie, as shares (p, 3) of corners."""
    thirds = 3 * PARTS
    upright = [(3 * i + 1, 3 * j + 1) for i in range(PARTS) for j in range(PARTS - i)]
    turned = [(3 * i + 2, 3 * j + 2) for i in range(PARTS) for j in range(PARTS - i - 1)]
    first = np.array(upright + turned) / thirds
    return np.column_stack([first, 1 - first.sum(axis=1)])


_SHARES = {2: _halved(), 3: _quartered()}


def _of_particles(state: State, row: np.ndarray, dp: float) -> Elements:
    """Pieces that stand for the particles of the first row."""
    normal, position, depth = (state[key][row] for key in ("normal", "position", "depth"))
    place = position + depth[:, None] * normal
    size = state["mass"][row] / state["density"][row] / dp
    size *= _over_plane(position, normal, depth, dp)
    parts = place[:, None] + dp * _squares(normal)
    return Elements(place, size[:, None] * normal, parts, state["body"][row])


def _first_row(state: State, chosen: np.ndarray, dp: float) -> np.ndarray:
    facing = np.linalg.norm(state["normal"], axis=1) > 0.5
    return np.flatnonzero(chosen & facing & (state["depth"] < dp))


def _over_plane(
    position: np.ndarray, normal: np.ndarray, depth: np.ndarray, dp: float
) -> np.ndarray:
    """Area (n,) of the surface over each particle, over that of a plane through it.

    An edge has neighbours of other normals on both sides, whose mean is its own: where m faces
    meet at right angles it has sqrt(m) of the area.  On a curved surface normals spread.
    """
    from scipy.spatial import cKDTree

    i, j = cKDTree(position).query_pairs(EDGE_REACH * dp, output_type="ndarray").T
    i, j = np.concatenate([i, j]), np.concatenate([j, i])
    alike = np.einsum("ij,ij->i", normal[i], normal[j])
    smooth = alike > LIKE
    spread = _spread(position, normal, i[smooth], j[smooth])
    curved = np.maximum(0.0, 1 + depth * spread) ** (position.shape[1] - 1)
    other = (alike > UNLIKE + 1e-6) & ~smooth
    i, j, alike = i[other], j[other], alike[other]
    n = len(position)
    count, least = np.bincount(i, minlength=n), np.ones(n)
    np.minimum.at(least, i, alike)
    aside = np.zeros_like(position)
    np.add.at(aside, i, normal[j] - alike[:, None] * normal[i])
    even = np.linalg.norm(aside, axis=1) < EVEN * np.maximum(count, 1)
    edges = np.round(1 / least**2) * least
    return np.where((count > 1) & even, edges, curved)


def _spread(position: np.ndarray, normal: np.ndarray, i: np.ndarray, j: np.ndarray) -> np.ndarray:
    """Mean curvature (n,), 1/m, from neighbours; of a ball 1 over the radius of the row."""
    apart = position[j] - position[i]
    turned = np.einsum("ij,ij->i", normal[j] - normal[i], apart)
    rate = turned / np.einsum("ij,ij->i", apart, apart)
    n = len(position)
    return np.bincount(i, rate, n) / np.maximum(np.bincount(i, minlength=n), 1)


def _squares(normal: np.ndarray) -> np.ndarray:
    """Points (n, p, dim) of a square of side 1 (2-D: a line) across each normal (n, dim)."""
    dim = normal.shape[1]
    along = (np.arange(PARTS) + 0.5) / PARTS - 0.5
    grid = np.stack(np.meshgrid(*[along] * (dim - 1), indexing="ij"), axis=-1)
    return np.einsum("pa,nab->npb", grid.reshape(-1, dim - 1), _across(normal))


def _across(normal: np.ndarray) -> np.ndarray:
    """Unit vectors (n, dim - 1, dim) across normals; along the axes where the normal is."""
    if normal.shape[1] == 2:
        return np.stack([-normal[:, 1], normal[:, 0]], axis=1)[:, None]
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = np.cross(normal, axis)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(normal, first)], axis=1)
