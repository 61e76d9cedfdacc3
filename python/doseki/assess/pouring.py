"""A grid of cells into which a flow is poured: where it gets out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..scenario.model import Scenario

CELL = 1.5  # spacings: walls of particles have no gaps for what goes from face to face
MAX_CELLS = 400_000
DOWNWARDS = 0.7  # cosine, of sides that are below


@dataclass(frozen=True)
class Fall:
    """Gravity without what of it lies along periodic axes, which nothing leaves."""

    down: np.ndarray  # (dim,), unit vector
    g: float  # m/s2
    time: float  # of the run, s
    outflows: list[tuple[np.ndarray, np.ndarray]]  # corners
    domain: tuple[np.ndarray, np.ndarray] | None  # corners, infinite along periodic axes

    @classmethod
    def of(cls, scenario: Scenario) -> Fall | None:
        """That of a scenario; None where nothing falls for ever."""
        gravity = scenario.gravity.copy()
        wraps = ["xyz".index(axis) for axis in scenario.periodic]
        gravity[wraps] = 0.0
        g = float(np.linalg.norm(gravity))
        if g == 0 or scenario.attraction > 0:
            return None
        corners = scenario.setting().domain
        if corners is not None:
            low, high = (corner.astype(float).copy() for corner in corners)
            low[wraps], high[wraps] = -np.inf, np.inf
            corners = low, high
        outflows = [(region.min, region.max) for region in scenario.outflow.values()]
        return cls(gravity / g, g, scenario.time_max, outflows, corners)

    def height(self, x: np.ndarray) -> np.ndarray:
        """Height (n,) of positions, m."""
        return np.asarray(-(x @ self.down))

    def head(self, points: np.ndarray, speed: float) -> float:
        """How high what starts at the points with that speed can get, m."""
        return float(self.height(points).max()) + speed**2 / (2 * self.g)

    def is_caught(self, x: np.ndarray) -> np.ndarray:
        """Mask (n,) of positions from which an outflow lies straight below."""
        caught = np.zeros(len(x), bool)
        for low, high in self.outflows:
            near, far = _along(x, self.down, low, high)
            caught |= (near <= far) & (far >= 0)
        return caught

    def stays_in_domain(self, x: np.ndarray, speed: float) -> np.ndarray:
        """Mask (n,) of positions from which the run is too short to fall out of the domain."""
        if self.domain is None:
            return np.zeros(len(x), bool)
        _, far = _along(x, self.down, *self.domain)
        return far > speed * self.time + 0.5 * self.g * self.time**2

    def is_below(self, axis: int, sign: int) -> bool:
        """Whether a side of the scene is its lower one."""
        return bool(sign * self.down[axis] > DOWNWARDS)

    def is_above(self, axis: int, sign: int) -> bool:
        """Whether a side of the scene is its upper one."""
        return self.is_below(axis, -sign)


def _along(
    x: np.ndarray, direction: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """How far (n,) from x along a direction a box begins and ends; begins after it ends: never."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(low - x) / direction, (high - x) / direction])
    inside = (x >= low) & (x <= high)
    level = direction == 0
    near = np.where(level, np.where(inside, -np.inf, np.inf), ends.min(axis=0))
    far = np.where(level, np.where(inside, np.inf, -np.inf), ends.max(axis=0))
    return near.max(axis=1), far.min(axis=1)


@dataclass(frozen=True)
class Exits:
    """Cells at the border of the grid that a flow reaches, and from which it falls for ever."""

    position: np.ndarray  # (n, dim), m
    side: np.ndarray  # (n, 2): axis, and -1 or 1

    def __bool__(self) -> bool:
        return len(self.position) > 0

    @property
    def sides(self) -> list[tuple[int, int]]:
        """The sides of the grid, each once."""
        return [(int(axis), int(sign)) for axis, sign in np.unique(self.side, axis=0)]

    def nearest(self, points: np.ndarray) -> np.ndarray:
        """The exit (dim,) that is nearest to some of the points."""
        return np.asarray(self.position[np.argmin(_gaps(points, self.position))])

    def within_reach(self, points: np.ndarray, speed: float, fall: Fall) -> Exits:
        """Those that what starts at the points can reach, and fall out of, in time.

        No flow runs faster than twice the speed of waves as high as it is above where it runs to,
        beside its own (Ritter 1892).
        """
        if not self:
            return self
        drop = np.maximum(0.0, fall.height(points).max() - fall.height(self.position))
        fastest = speed + 2 * np.sqrt(fall.g * drop)
        reached = _gaps(points, self.position) <= fastest * fall.time
        reached &= ~fall.stays_in_domain(self.position, float(fastest.max()))
        return Exits(self.position[reached], self.side[reached])


def _gaps(points: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Distance (n,) of each x from the nearest of the points."""
    from scipy.spatial import cKDTree

    return np.asarray(cKDTree(points).query(x)[0])


@dataclass(frozen=True)
class Cells:
    """Cells around all particles, of which walls fill some; a layer of empty ones is around them.

    Along periodic axes they are those of the period.
    """

    low: np.ndarray  # (dim,), m
    size: np.ndarray  # (dim,), of a cell, m
    wall: np.ndarray  # bool, one entry a cell
    wraps: tuple[int, ...]  # periodic axes
    asked: float  # m, what walls of particles ask cells to be

    @classmethod
    def of(cls, scenario: Scenario, walls: np.ndarray, others: list[np.ndarray]) -> Cells:
        """The cells around the points (n, dim) of walls, and others."""
        points = np.concatenate([walls, *others])
        low, high = points.min(axis=0), points.max(axis=0)
        spacings = [body.given("dp") or scenario.dp for body in scenario.body.values()]
        asked = CELL * max([scenario.dp, *spacings])
        cell = max(
            asked, (float(np.prod(high - low + 2 * asked)) / MAX_CELLS) ** (1 / scenario.dim)
        )
        low, high = low - 1.5 * cell, high + 1.5 * cell
        wraps = tuple("xyz".index(axis) for axis in scenario.periodic)
        for axis in wraps:
            low[axis], high[axis] = scenario.ends_of(axis)
        count = np.maximum(1, np.ceil((high - low) / cell - 1e-9)).astype(int)
        size = np.full(scenario.dim, cell)
        for axis in wraps:
            count[axis] = max(1, int((high[axis] - low[axis]) / cell))
            size[axis] = (high[axis] - low[axis]) / count[axis]
        return cls(low, size, np.zeros(count, bool), wraps, asked).filled(walls)

    def filled(self, points: np.ndarray) -> Cells:
        """These cells with walls at points (n, dim) as well."""
        wall = self.wall.copy()
        if len(points):
            wall[self._index(points)] = True
        return replace(self, wall=wall)

    def is_wall(self, x: np.ndarray) -> np.ndarray:
        """Mask (n,) of the positions in cells that walls fill."""
        return np.asarray(self.wall[self._index(x)])

    @property
    def is_coarse(self) -> bool:
        """Whether cells are larger than walls ask for, so that narrow ways are closed."""
        return self.cell > 2 * self.asked

    @property
    def cell(self) -> float:
        """The longest side of a cell, m."""
        return float(self.size.max())

    def _index(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        """The cells of positions; what is outside is in the nearest."""
        index = np.floor((x - self.low) / self.size).astype(int)
        for axis, count in enumerate(self.wall.shape):
            wraps = axis in self.wraps
            index[:, axis] = index[:, axis] % count if wraps else index[:, axis].clip(0, count - 1)
        return tuple(index.T)

    def _centres(self, mask: np.ndarray) -> np.ndarray:
        """The middles (n, dim) of cells."""
        return self.low + (np.argwhere(mask) + 0.5) * self.size

    def poured(self, points: np.ndarray, head: float, fall: Fall) -> Exits:
        """The exits of a flow from the points that gets no higher than `head`, m.

        What rises over the upper side comes down again: it gets out beside the scene or not at all.
        """
        free = self._below(head, fall)
        reached = self._reached(points, free, fall)
        found, sides = [np.zeros((0, len(self.low)))], [np.zeros((0, 2), int)]
        for axis, sign, border, beside in self._borders(fall):
            out = np.zeros_like(free)
            layer = _layer(self.wall, axis, border)
            out[layer] = reached[_layer(self.wall, axis, beside)] & free[layer]
            x = self._centres(out)
            x = x[~fall.is_caught(x)]
            found.append(x)
            sides.append(np.tile([axis, sign], (len(x), 1)))
        return Exits(np.concatenate(found), np.concatenate(sides))

    def lowest_room(self, points: np.ndarray, head: float, fall: Fall) -> float:
        """Height of the lowest place, m, that such a flow reaches where none of the points is.

        That of the highest point where there is none.
        """
        reached = self._reached(points, self._below(head, fall), fall)
        reached[self._index(points)] = False
        rooms = fall.height(self._centres(reached) + 0.5 * self.size * np.sign(fall.down))
        return float(rooms.min(initial=float(fall.height(points).max())))

    def _below(self, head: float, fall: Fall) -> np.ndarray:
        """The cells up to a height that neither walls nor outflows fill."""
        everywhere = self._centres(np.ones_like(self.wall))
        free = ~self.wall & (fall.height(everywhere) <= head).reshape(self.wall.shape)
        free.reshape(-1)[_in_outflows(everywhere, fall)] = False
        return free

    def _reached(self, points: np.ndarray, free: np.ndarray, fall: Fall) -> np.ndarray:
        """The free cells within the borders that a flow from the points reaches."""
        inner = free.copy()
        for axis, _, border, _ in self._borders(fall):
            inner[_layer(self.wall, axis, border)] = False
        start = np.zeros_like(inner)
        start[self._index(points)] = True
        return self._spread(start & inner, inner)

    def _borders(self, fall: Fall) -> Iterator[tuple[int, int, int, int]]:
        """The sides that something may leave for ever: axis, sign, their layer, the one inside."""
        for axis in range(self.wall.ndim):
            for sign, border, beside in ((-1, 0, 1), (1, -1, -2)):
                if axis not in self.wraps and not fall.is_above(axis, sign):
                    yield axis, sign, border, beside

    def _spread(self, start: np.ndarray, free: np.ndarray) -> np.ndarray:
        """The cells that are reached from face to face through free ones, also around a period."""
        from scipy.ndimage import binary_propagation

        reached, before = start, -1
        while (count := int(reached.sum())) != before:
            before = count
            reached = binary_propagation(reached, mask=free)
            for axis in self.wraps:
                first, last = _layer(free, axis, 0), _layer(free, axis, -1)
                both = reached[first] | reached[last]
                reached[first] |= both & free[first]
                reached[last] |= both & free[last]
        return np.asarray(reached)

    def lets_fall(self, x: np.ndarray, speed: float, fall: Fall) -> np.ndarray:
        """Mask (n,) of positions below which there is neither wall nor outflow, nor the domain."""
        falls = ~fall.is_caught(x) & ~fall.stays_in_domain(x, speed)
        step = 0.5 * float(self.size.min()) * fall.down
        extent = float(np.linalg.norm(self.size * self.wall.shape))
        x = x.copy()
        for _ in range(int(extent / float(np.linalg.norm(step))) + 1):
            falls &= ~self.is_wall(x)
            x += step
            if not falls.any():
                break
        return falls


def _layer(cells: np.ndarray, axis: int, index: int) -> tuple[slice | int, ...]:
    """The index of one layer of cells across an axis."""
    return tuple(index if a == axis else slice(None) for a in range(cells.ndim))


def _in_outflows(x: np.ndarray, fall: Fall) -> np.ndarray:
    """Mask (n,) of positions in an outflow."""
    inside = np.zeros(len(x), bool)
    for low, high in fall.outflows:
        inside |= ((x >= low) & (x <= high)).all(axis=1)
    return inside
