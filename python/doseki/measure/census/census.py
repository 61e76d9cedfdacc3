"""A census of the grains of a run: where each is, how it moves, and what the flow does with it.

Grains are the rows of a snapshot's table of bodies; in a run without one (scheme ueta2022) every
free particle of a solid is a grain.  Classes are defined in docs/census.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from ...errors import UserError
from ...record.reader import Run
from .. import numbers as measure
from ..grading import structure_names
from ..views import View, flow_direction, fluid_names, way_of_flow
from .columns import Columns, Plan, plan_of
from .grains import Grains, Surroundings, grains_of, surroundings_of
from .lineage import Lineage

CLASSES = ("waiting", "preceding", "carried", "floating", "rolling", "deposited")
WAITING, PRECEDING, CARRIED, FLOATING, ROLLING, DEPOSITED = range(len(CLASSES))
AT_REST = 0.05  # m/s
TOUCHING = 0.2  # diameters between a grain and a fixed body
WET_DEPTH = 0.1  # diameters of water that make a column wet
FRONT_DEPTH = 0.4  # diameters of water that make a flow, in a column and over a stretch of them


def classify(
    grains: Grains,
    start: np.ndarray,
    around: Surroundings,
    direction: int,
    plan: Plan | None = None,
) -> tuple[np.ndarray, float]:
    """(class of each grain, front of the water along the first axis, m; nan without water).

    `start` (n, dim) is where each grain was first; the flow runs along `direction` (+1, -1);
    `plan` is where columns are, if not as these grains have them.
    """
    if not len(grains.id):
        return np.zeros(0, np.int8), math.nan
    columns = Columns(grains, around, plan or plan_of(grains, around))
    d, here = grains.diameter, columns.of_grain
    front = columns.front(direction, FRONT_DEPTH * float(d.mean()))
    slow = grains.speed < AT_REST
    displaced = np.linalg.norm(grains.position - start, axis=1) >= d
    ahead = direction * (grains.position[:, 0] - front) > 0 if np.isfinite(front) else ~slow
    height = grains.position[:, -1] - columns.bed[here]
    wet = columns.water[here] > WET_DEPTH * d
    kinds = np.full(len(d), CARRIED, np.int8)
    kinds[wet & (height > 0.5 * columns.depth[here])] = FLOATING
    kinds[_gap(grains, around) <= TOUCHING * d] = ROLLING
    kinds[ahead] = PRECEDING
    kinds[slow] = np.where(displaced, DEPOSITED, WAITING)[slow]
    return kinds, front


def _gap(grains: Grains, around: Surroundings) -> np.ndarray:
    """Distance (n,) between the surface of each grain and that of the nearest fixed particle, m."""
    if not len(around.fixed):
        return np.full(len(grains.id), math.inf)
    distance, nearest = cKDTree(around.fixed).query(grains.position)
    return distance - 0.5 * (grains.diameter + around.fixed_spacing[nearest])


@dataclass(frozen=True)
class Census:
    """The grains of all snapshots of a run, one row for each grain and time.

    `table` has time, id, position (N, dim), velocity (N, dim), spin (N, 3), contacts, diameter,
    mass, is_part, kind (index into CLASSES), is_load and source (see Lineage), sorted by time;
    `front` (T,) is that of the water, m.
    `direction` is that of the flow along the first axis, +1 or -1; 0 where nothing says it.
    """

    times: np.ndarray
    front: np.ndarray
    table: dict[str, np.ndarray]
    direction: int

    @cached_property
    def load_mass(self) -> float:
        """Mass of the load, kg (2-D: kg/m): grains loose at first, and others that came later.

        Parts that come off them are in it, what comes off structures is not; 0 without a load.
        """
        _, first = np.unique(self.table["id"], return_index=True)
        whole = (self.table["time"][first] == self.times[0]) | ~self.table["is_part"][first]
        return float((self.table["mass"][first] * whole).sum())

    def share(self, mass: np.ndarray) -> np.ndarray:
        """Masses, kg (2-D: kg/m), over that of the load; nan without one."""
        return np.asarray(mass) / self.load_mass if self.load_mass else np.full_like(mass, math.nan)

    @cached_property
    def off_structures(self) -> np.ndarray:
        """Mass (T,) that has come off structures by each time, kg (2-D: kg/m)."""
        new = ~self.table["is_load"] & (self.table["source"] < 0)
        return np.cumsum(self._sums(new))

    def rows(
        self, view: View | None = None, start: float = -math.inf, end: float = math.inf
    ) -> np.ndarray:
        """Mask (N,) of the rows inside a window and a range of time, both ends included."""
        time = self.table["time"]
        mask = (time >= start) & (time <= end)
        return mask if view is None else mask & view.contains(self.table["position"])

    def mass_of(self, kind: int) -> np.ndarray:
        """Mass (T,) of the load in a class over time, kg (2-D: kg/m)."""
        return self._sums((self.table["kind"] == kind) & self.table["is_load"])

    def _sums(self, rows: np.ndarray) -> np.ndarray:
        """Mass (T,) of the rows of a mask at each time."""
        index = np.searchsorted(self.times, self.table["time"][rows])
        return np.bincount(index, self.table["mass"][rows], len(self.times))

    def passed(self, section: float, load: bool = True) -> np.ndarray:
        """Mass (T,) of the load, or of what came off structures, beyond x = `section`.

        It is in kg (2-D: kg/m), and counts what has crossed the section by each time.
        """
        return self._pass(section, load)[0]

    def passed_count(self, section: float, load: bool = True) -> int:
        """Number of grains of the same that have crossed x = `section` by the end."""
        return self._pass(section, load)[1]

    @cached_property
    def _passes(self) -> dict[tuple[float, bool], tuple[np.ndarray, int]]:
        """What `_pass` has counted so far."""
        return {}

    def _pass(self, section: float, load: bool) -> tuple[np.ndarray, int]:
        if (section, load) in self._passes:
            return self._passes[section, load]
        passed, masses = measure.PassedMass(section, self.direction), []
        for there in self._slices():
            own = self.table["is_load"][there] == load
            x, mass, ids, source = (
                self.table[key][there][own] for key in ("position", "mass", "id", "source")
            )
            masses.append(passed.update(x[:, 0], mass, ids, source))
        self._passes[section, load] = np.array(masses), passed.count
        return self._passes[section, load]

    def _slices(self) -> Iterator[slice]:
        starts = np.searchsorted(self.table["time"], self.times)
        for a, b in zip(starts, [*starts[1:], len(self.table["time"])], strict=True):
            yield slice(int(a), int(b))

    def last(self) -> np.ndarray:
        """Mask (N,) of the rows of the last time."""
        return self.table["time"] == self.times[-1]


def take_census(run: Run) -> Census:
    """The census of all snapshots; raises UserError for a run without grains or snapshots."""
    fluids, structures, way = fluid_names(run), structure_names(run), way_of_flow(run) or 1
    lineage = Lineage(structures)
    first: dict[int, np.ndarray] = {}
    parts: list[dict[str, np.ndarray]] = []
    fronts: list[float] = []
    plan: Plan | None = None
    times = np.unique(run.times)
    for time in times:  # a run that was stopped has its last time twice
        snapshot = run.at(time)
        grains = grains_of(snapshot, fluids, structures)
        start = np.array(
            [
                first.setdefault(k, x)
                for k, x in zip(grains.id.tolist(), grains.position, strict=True)
            ]
        ).reshape(-1, snapshot.dim)
        around = surroundings_of(snapshot, fluids)
        if plan is None and len(grains.id):
            plan = plan_of(grains, around)
        kinds, front = classify(grains, start, around, way, plan)
        load, source = lineage.look(snapshot, grains.id)
        more = {"kind": kinds, "is_load": load, "source": source}
        parts.append({"time": np.full(len(grains.id), time)} | vars(grains) | more)
        fronts.append(front)
    if not first:
        raise UserError(f"{run.directory}: the run has no grains to take a census of")
    table = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    return Census(times, np.array(fronts), table, flow_direction(run))


@dataclass(frozen=True)
class SpeedDraws:
    """Speeds of grains in bins, and how much a random sample of `size` of them varies."""

    speeds: np.ndarray  # all of them, m/s
    edges: np.ndarray  # of the bins
    counts: np.ndarray  # of all
    mean: np.ndarray  # per bin, of samples
    low: np.ndarray  # 5 % quantile
    high: np.ndarray  # 95 % quantile
    sample_means: np.ndarray  # (draws,) mean speed of each sample, m/s
    size: int


def draw_speeds(
    speeds: np.ndarray, bin_width: float = 0.1, size: int = 30, draws: int = 2000, seed: int = 0
) -> SpeedDraws:
    """Histogram of `speeds` in bins of `bin_width` m/s, and `draws` random samples of `size`."""
    edges, counts = measure.speed_histogram(speeds, bin_width)
    size = min(size, len(speeds))
    mean, low, high = measure.sampled_histogram(speeds, edges, size, draws, seed)
    random = np.random.default_rng(seed)
    means = [random.choice(speeds, size, replace=False).mean() for _ in range(draws if size else 0)]
    return SpeedDraws(speeds, edges, counts, mean, low, high, np.array(means), size)


def deposit_outline(census: Census, view: View) -> np.ndarray:
    """Outline (k, 2) of what lies deposited in a window at the end, in the axes of the window, m.

    In 2-D the top of the deposit over the first axis, one point for each column that has grains;
    in 3-D the convex outline in plan.  Fewer than 3 grains have none in 3-D.
    """
    there = census.last() & census.rows(view) & (census.table["kind"] == DEPOSITED)
    x = view.coordinates(census.table["position"][there])
    radius = 0.5 * census.table["diameter"][there]
    if x.shape[1] == 3:
        return _hull(x[:, :2])
    if not len(x):
        return np.zeros((0, 2))
    width = 2 * float(radius.mean())
    column, index = np.unique(np.floor(x[:, 0] / width), return_inverse=True)
    top = np.full(len(column), -math.inf)
    np.maximum.at(top, index, x[:, 1] + radius)
    return np.column_stack([(column + 0.5) * width, top])


def _hull(plan: np.ndarray) -> np.ndarray:
    from scipy.spatial import ConvexHull, QhullError

    try:
        return plan[ConvexHull(plan).vertices]
    except (QhullError, ValueError):
        return np.zeros((0, 2))
