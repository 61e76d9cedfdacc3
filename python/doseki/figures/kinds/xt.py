"""x-t diagrams: the depth of the flow along a line, over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ...record.reader import Run, Snapshot
from ...scenario.gauges.gauge import Setting, State
from ...scenario.gauges.surface_height import SurfaceHeight
from ...scenario.tables.figure import DepthFigure
from ...scenario.values.directions import upwards
from ..layout import chart_grid

FIELDS = ("position", "velocity", "density", "pressure", "mass", "motion")
SCALE, DRY = "viridis", "#e0e0e0"


class Depths(NamedTuple):
    """Depth, m, at each time, s (T,), and distance along a line, m (N,): (T, N)."""

    times: np.ndarray
    distances: np.ndarray
    depth: np.ndarray


def draw_depth(run: Run, name: str, table: DepthFigure) -> Figure:
    """The figure [figure.NAME]: distance to the right, time upwards, depth as colour."""
    found = depths_along(run, table)
    figure, grid = chart_grid(1, 1, (6.5, 4.5), table.title or "Depth along the line")
    axes = grid[0, 0]
    # Edges of the cells, so that each depth stands around its point and its moment.
    edges = _edges(found.distances), _edges(found.times)
    shown = np.ma.masked_equal(found.depth, 0.0)
    mesh = axes.pcolormesh(*edges, shown, cmap=SCALE, vmin=0.0)
    axes.set_facecolor(DRY)
    axes.set(xlabel="distance along the line (m)", ylabel="time (s)")
    figure.colorbar(mesh, ax=axes).set_label("depth (m)", fontsize="small")
    return figure


def depths_along(run: Run, table: DepthFigure) -> Depths:
    """What gauges of kind surface_height along the line would read from each snapshot."""
    along = table.end - table.start
    share = (np.arange(table.count) + 0.5) / table.count
    up = upwards(_gravity(run), table.direction)
    gauges = [
        SurfaceHeight.model_construct(
            kind="surface_height",
            position=table.start + part * along,
            direction=up,
            material=table.material,
        )
        for part in share
    ]
    depth = np.empty((len(run), table.count))
    for row, snapshot in enumerate(run):
        still, setting = _Still(snapshot, along), _setting(run, snapshot)
        depth[row] = [gauge.read(still, setting)[0][1] for gauge in gauges]
    return Depths(run.times, share * float(np.linalg.norm(along)), depth)


class _Still:
    """A snapshot as gauges look at a simulation."""

    def __init__(self, snapshot: Snapshot, along: np.ndarray) -> None:
        """`along` (dim,) is the line at which most looks are directed."""
        fields: dict[str, np.ndarray] = {name: snapshot[name] for name in FIELDS}
        fields["material"] = snapshot.stored("material")
        self.time = snapshot.time
        self._axis = int(np.argmax(np.abs(along)))
        order = np.argsort(fields["position"][:, self._axis], kind="stable")
        self._fields = {name: values[order] for name, values in fields.items()}
        self._along = self._fields["position"][:, self._axis]

    def state(self) -> State:
        """All particles."""
        return self._fields

    def grains(self) -> State:
        """None: they are particles, too."""
        return {}

    def totals(self) -> State:
        """None: they are of the whole run."""
        return {}

    def sample(self, low: Sequence[float], high: Sequence[float]) -> State:
        """Those in a box: of a sorted axis only what can be in it is looked at."""
        near = slice(
            np.searchsorted(self._along, low[self._axis]),
            np.searchsorted(self._along, high[self._axis], side="right"),
        )
        position = self._fields["position"][near]
        inside = ((position >= low) & (position <= high)).all(axis=1)
        return {name: values[near][inside] for name, values in self._fields.items()}


def _gravity(run: Run) -> np.ndarray:
    return np.array(run.scenario.get("gravity", [0.0] * run.scenario["dim"]), dtype=float)


def _setting(run: Run, snapshot: Snapshot) -> Setting:
    scenario: dict[str, Any] = run.scenario
    corners = [scenario.get(key) for key in ("domain_min", "domain_max")]
    low, high = (None if corner is None else np.array(corner, float) for corner in corners)
    return Setting(
        dim=scenario["dim"],
        dp=scenario["dp"],
        timestep=0.0,  # nothing steps any more
        scheme=scenario.get("scheme", ""),
        gravity=_gravity(run),
        periodic=tuple("xyz".index(axis) for axis in scenario.get("periodic", [])),
        domain=None if low is None or high is None else (low, high),
        fixed={},
        kinematics={},
        material_names=snapshot.material_names,
        body_names=snapshot.body_names,
        named={},
    )


def _edges(middles: np.ndarray) -> np.ndarray:
    """Limits (n + 1,) of the cells around points (n,); one point alone has a cell of length 1."""
    if len(middles) == 1:
        return middles[0] + np.array([-0.5, 0.5])
    between = 0.5 * (middles[1:] + middles[:-1])
    return np.concatenate([[2 * middles[0] - between[0]], between, [2 * middles[-1] - between[-1]]])
