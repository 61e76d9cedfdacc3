"""The share of the space that particles take, smoothed by the kernel, on blocks of a grid.

Nodes stand at whole multiples of the cell, whatever the particles: surfaces of two times fit
together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...errors import UserError

SIDE = 40  # cells of a block; it has one node more
AT_ONCE = 2_000_000  # pairs of a particle and a node
MOST_WORK = 3e10  # such pairs, and nodes, of one surface: some ten minutes
FINEST, COARSEST = 12.0, 1.0  # cells in the reach of a particle
HALF = 0.5  # share of solid at a wall's face
NEAR = 1e-4  # of a share: a level nearer to a node than this is moved away from it


@dataclass(frozen=True)
class Cloud:
    """Particles: places (n, dim) m, volumes (n,) m3 (2-D: m2), reach (n,) m; which are solid."""

    position: np.ndarray
    volume: np.ndarray
    reach: np.ndarray
    solid: np.ndarray

    @property
    def dim(self) -> int:
        """Number of space dimensions."""
        return int(self.position.shape[1])

    def only(self, chosen: np.ndarray) -> Cloud:
        """Some of them."""
        return Cloud(*(values[chosen] for values in vars(self).values()))


class Block(NamedTuple):
    """A cube of the grid: its first node, and at its nodes what is above zero inside."""

    first: np.ndarray  # (dim,) int64, in cells
    values: np.ndarray  # (SIDE + 1,) * dim


@dataclass(frozen=True)
class Grid:
    """Where the surface is looked for: cells, m, the level, and faces where space is repeated."""

    cell: float
    level: float
    kernel: str
    periods: tuple[tuple[int, float, float], ...] = ()  # axis, its ends, m


def weight(kernel: str, share: np.ndarray, dim: int) -> np.ndarray:
    """The kernel times the reach to the power `dim`, at shares of its reach from 0 to 1.

    Wendland's C2 and C6 functions (doi:10.1007/BF02123482; Dehnen & Aly 2012,
    doi:10.1111/j.1365-2966.2012.21439.x): their integral over the space is 1.
    """
    fourth = np.square(np.square(1.0 - share))  # many times faster than a power
    if kernel == "wendland_c2":
        scale = {2: 7 / np.pi, 3: 21 / (2 * np.pi)}[dim]
        return np.asarray(scale * fourth * (1 + 4 * share))
    scale = {2: 78 / (7 * np.pi), 3: 1365 / (64 * np.pi)}[dim]
    return np.asarray(scale * fourth * fourth * (1 + share * (8 + share * (25 + 32 * share))))


def blocks(cloud: Cloud, grid: Grid) -> Iterator[Block]:
    """The blocks in which something is inside, one after the other.

    What is inside is f / (1 - s) > level where s < 1/2, f and s being the shares of fluid and of
    solid: of the space that walls leave, so much is fluid. Without walls that is f > level.

    Raises:
        UserError: the cell is too fine or too coarse for the particles.

    """
    if cloud.solid.all():
        return
    check_cell(cloud, grid.cell)
    cloud = _with_images(cloud, grid)
    particle, key = _members(cloud, grid.cell)
    keys, start = np.unique(key, axis=0, return_index=True)
    _check_work(len(keys), cloud, grid.cell)
    ends = [*start[1:], len(key)]
    for first, begin, end in zip(keys * SIDE, start, ends, strict=True):
        near = cloud.only(particle[begin:end])
        yield Block(first, _inside(near, first, grid))


def check_cell(cloud: Cloud, cell: float) -> None:
    """Raise UserError where particles do not fit the cell."""
    reach = float(np.median(cloud.reach[~cloud.solid]))
    low, high = reach / FINEST, reach / COARSEST
    if not low * (1 - 1e-9) <= cell <= high:
        raise UserError(
            f"--cell {cell:g}: a particle acts as far as {reach:.3g} m; cells are to be from "
            f"{low:.3g} to {high:.3g} m"
        )


def _check_work(count: int, cloud: Cloud, cell: float) -> None:
    nodes = count * (SIDE + 1.0) ** cloud.dim
    pairs = float(((2 * cloud.reach / cell + 1) ** cloud.dim).sum())
    work = nodes + pairs
    if work > MOST_WORK:
        fits = cell * (work / MOST_WORK) ** (1 / cloud.dim)
        raise UserError(
            f"--cell {cell:g}: the surface would take {work:.2g} steps, and {MOST_WORK:.2g} are "
            f"allowed; --cell {fits:.2g} fits"
        )


def _with_images(cloud: Cloud, grid: Grid) -> Cloud:
    """With the images of particles near periodic faces."""
    for axis, low, high in grid.periods:
        x, shift = cloud.position[:, axis], np.zeros(cloud.dim)
        shift[axis] = high - low
        after, before = cloud.only(x < low + cloud.reach), cloud.only(x > high - cloud.reach)
        images = (
            (cloud.position, after.position + shift, before.position - shift),
            *((getattr(cloud, k), getattr(after, k), getattr(before, k)) for k in KEPT),
        )
        cloud = Cloud(*(np.concatenate(each) for each in images))
    return cloud


KEPT = ("volume", "reach", "solid")


def _members(cloud: Cloud, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """Each block that fluid reaches, and what reaches it: particles (k,) and blocks (k, dim).

    In the order of blocks, and in each of particles.
    """
    reach = cloud.reach[:, None]
    first = np.ceil((cloud.position - reach) / cell).astype(np.int64)
    last = np.floor((cloud.position + reach) / cell).astype(np.int64)
    # A node on the face of two blocks belongs to both.
    low, high = -(-first // SIDE) - 1, last // SIDE
    particles, keys = [], []
    for offset in np.ndindex(*((high - low).max(axis=0) + 1)):
        key = low + offset
        there = np.flatnonzero((key <= high).all(axis=1))
        particles.append(there)
        keys.append(key[there])
    particle, key = np.concatenate(particles), np.concatenate(keys)
    wet = np.unique(key[~cloud.solid[particle]], axis=0)
    wanted = np.isin(_joined(key, wet), _joined(wet, wet))
    particle, key = particle[wanted], key[wanted]
    order = np.lexsort((particle, *key.T[::-1]))
    return particle[order], key[order]


def _joined(keys: np.ndarray, of: np.ndarray) -> np.ndarray:
    """One number (k,) for each row (k, dim); -1 for what is outside of the extent of `of`."""
    low, size = of.min(axis=0), np.ptp(of, axis=0) + 1
    away = keys - low
    inside = ((away >= 0) & (away < size)).all(axis=1)
    number = np.full(len(keys), -1, np.int64)
    number[inside] = np.ravel_multi_index(tuple(away[inside].T), tuple(size))
    return number


def _inside(near: Cloud, first: np.ndarray, grid: Grid) -> np.ndarray:
    """At the nodes of a block: above zero inside, and nowhere near zero."""
    fluid = share_of(near.only(~near.solid), first, grid)
    solid = share_of(near.only(near.solid), first, grid)
    inside = fluid / np.maximum(1 - solid, HALF) - grid.level
    if near.solid.any():
        inside = np.minimum(inside, HALF - solid)
    for axis, low, high in grid.periods:
        x = (first[axis] + np.arange(SIDE + 1)) * grid.cell
        away = np.minimum(x - low, high - x) / (4 * grid.cell)
        shape = [1] * near.dim
        shape[axis] = SIDE + 1
        inside = np.minimum(inside, away.reshape(shape))
    inside[np.abs(inside) < NEAR] = NEAR
    return inside


def share_of(cloud: Cloud, first: np.ndarray, grid: Grid) -> np.ndarray:
    """The smoothed share of the space at the nodes of the block from node `first`.

    Sums go by the order of particles, so that two blocks agree on the nodes that they share.
    """
    dim, cell = cloud.dim, grid.cell
    nodes = np.zeros((SIDE + 1) ** dim)
    if not len(cloud.volume):
        return nodes.reshape((SIDE + 1,) * dim)
    steps = np.arange(int(np.floor(2 * cloud.reach.max() / cell)) + 1)
    count = max(1, AT_ONCE // len(steps) ** dim)
    for begin in range(0, len(cloud.volume), count):
        some = cloud.only(np.arange(begin, min(begin + count, len(cloud.volume))))
        owner, number, square = _pairs(some, first, cell, steps)
        distance = np.sqrt(square) / some.reach[owner]
        scale = (some.volume / some.reach**dim)[owner]
        np.add.at(nodes, number, scale * weight(grid.kernel, distance, dim))
    return nodes.reshape((SIDE + 1,) * dim)


def _pairs(
    some: Cloud, first: np.ndarray, cell: float, steps: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Particles, nodes of the block and squared distances, m2, of pairs in reach, by particle."""
    owner, number = np.arange(len(some.volume)), np.zeros(len(some.volume), np.int64)
    square, limit = np.zeros(len(some.volume)), some.reach**2
    for axis in range(some.dim):
        x = some.position[:, axis]
        node = np.ceil((x - some.reach) / cell).astype(np.int64)[:, None] + steps
        away = np.square(node * cell - x[:, None])
        within = node - first[axis]
        away[(within < 0) | (within > SIDE)] = np.inf
        # What is too far along the axes so far needs no look along the others.
        total = square[:, None] + away[owner]
        row, step = np.nonzero(total < limit[owner][:, None])
        number = number[row] * (SIDE + 1) + within[owner[row], step]
        square, owner = total[row, step], owner[row]
    return owner, number, square
