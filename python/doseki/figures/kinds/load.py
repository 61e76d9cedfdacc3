"""Loads on structures over time, and pressures on the panels of a face."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...errors import UserError
from ...measure.views import gauge_record, tables
from ...record.reader import GaugeRecord, Run
from ...scenario.gauges.gauge import Gauge
from ...scenario.gauges.loads.load import PARTS, Load
from ...scenario.gauges.loads.panels import Panels
from ...scenario.tables.figure import LoadFigure
from ...util.spelling import suggestion
from ..layout import SMALL, chart_grid, figure_legend
from ..nothing import NothingToDrawError
from .series import draw_curve, draw_curves

ROUNDING = 1e-9  # of the largest component, or of contacts: what is below is no force or moment
WHOLE = "total"
ALL = (WHOLE, *PARTS)
LARGE = 4.0  # times what the flow gives, from which on contacts stand beside it
TOGETHER = {"": ALL}  # parts by the heading of a column of panels
BESIDE = {"flow": ("static", "dynamic"), "flow and contacts": (WHOLE, "contact")}
TALL, LOW = 2.4, 1.8  # inches of a panel; of one of more than three


def draw_load(run: Run, name: str, table: LoadFigure) -> Figure:
    """The figure [figure.NAME] of a gauge of kind load or panels.

    Raises UserError if the gauge has left no record.
    """
    gauges = tables(run, "gauge", Gauge)
    if table.gauge not in gauges:
        known = suggestion(table.gauge, gauges)
        raise UserError(f"{run.directory}: no gauge {table.gauge!r}{known}")
    record, gauge = gauge_record(run, table.gauge), gauges[table.gauge]
    if len(np.unique(record["time"])) < 2:
        raise NothingToDrawError(f"{table.gauge} has no two samples")
    acted = [record[name] for name, unit in record.units.items() if unit[:1] in ("N", "P")]  # Pa
    if not np.nan_to_num(acted).any():
        raise NothingToDrawError(f"nothing acted on what {table.gauge} reads")
    title = table.title or table.gauge
    if isinstance(gauge, Panels):
        return _draw_panels(record, gauge, title)
    assert isinstance(gauge, Load)
    return _draw_parts(record, run.scenario["dim"], title)


def _draw_parts(record: GaugeRecord, dim: int, title: str) -> Figure:
    """A panel for each component of the force, and in 2-D the moment: the total and its parts.

    Where contacts would squash what the flow gives they have panels of their own beside it.
    """
    shown = [f"force_{axis}" for axis in "xyz"[:dim]]
    shown += ["moment"] if dim == 2 else [f"moment_{axis}" for axis in "xyz"]
    columns = BESIDE if _contacts_are_large(record, shown) else TOGETHER
    height = TALL if len(shown) <= 3 else LOW
    wide = 7.0 if len(columns) == 1 else 4.5
    figure, grid = chart_grid(len(shown), len(columns), (wide, height), title)
    for (heading, parts), panels in zip(columns.items(), grid.T, strict=True):
        sizes = [
            _draw_component(axes, record, column, parts)
            for axes, column in zip(panels, shown, strict=True)
        ]
        for kind in ("force", "moment"):
            alike = [k for k, column in enumerate(shown) if column.startswith(kind)]
            _share_scale([panels[k] for k in alike], [sizes[k] for k in alike])
        panels[0].set_title(heading, **SMALL)
        panels[-1].set_xlabel("time (s)")
    for axes, column in zip(grid[:, 0], shown, strict=True):
        axes.set_ylabel(f"{column.replace('_', ' ')} ({record.units[column]})")
    figure_legend(figure, grid[0])
    return figure


def _contacts_are_large(record: GaugeRecord, shown: Iterable[str]) -> bool:
    """Whether the largest contact force or moment is so many times what the flow gives."""
    for kind in ("force", "moment"):
        contact, static, dynamic = (
            _size(record[f"{part}_{c}"][1:] for c in shown if c.startswith(kind))
            for part in ("contact", "static", "dynamic")
        )
        flow = max(static, dynamic)
        if flow > ROUNDING * contact and contact > LARGE * flow:
            return True
    return False


def _draw_component(axes: Axes, record: GaugeRecord, column: str, parts: Sequence[str]) -> float:
    """Some parts of a component over time, always in the same colours; returns their size."""
    time = 0.5 * (record["time"][1:] + record["time"][:-1])  # of means
    curves = {part: record[column if part == WHOLE else f"{part}_{column}"][1:] for part in parts}
    for part, values in curves.items():
        draw_curve(axes, time, values, part, ALL.index(part))
    axes.grid(alpha=0.3)
    if WHOLE in parts:
        seen = axes.get_ylim()  # single steps of a collision would squash the means
        steps = record["peak_time"][1:], record[f"peak_{column}"][1:]
        axes.plot(*steps, ".", color="0.6", markersize=2, zorder=0, label="largest step")
        axes.set_ylim(seen)
    return _size(curves.values())


def _size(curves: Iterable[np.ndarray]) -> float:
    """The largest size of what is known of some curves."""
    values = np.concatenate(list(curves))
    return float(np.abs(values[np.isfinite(values)]).max(initial=0.0))


def _share_scale(panels: list[Axes], sizes: list[float]) -> None:
    """Draw what is nothing but rounding on the scale of the largest component, and zero in it."""
    largest = int(np.argmax(sizes))
    low, high = panels[largest].get_ylim()
    for axes, size in zip(panels, sizes, strict=True):
        if size < ROUNDING * sizes[largest]:
            axes.set_ylim(min(low, 0.0), max(high, 0.0))


def _draw_panels(record: GaugeRecord, gauge: Panels, title: str) -> Figure:
    """Where the flow, and where contacts press when they do most, and both over time."""
    time = np.unique(record["time"])
    shape = len(time), int(np.prod(gauge.panels))
    parts = {
        part: record[f"{key}_pressure"].reshape(shape)[1:]
        for part, key in (("flow", "flow"), ("contacts", "contact"))
    }
    shown = [part for part, pressure in parts.items() if pressure.any()] or ["flow"]
    figure, grid = chart_grid(2 * len(shown), 1, (7.0, 2.6), title, sharex=False)
    middles = 0.5 * (time[1:] + time[:-1])
    for axes, below, part in zip(grid[::2, 0], grid[1::2, 0], shown, strict=True):
        pressure = parts[part]
        peak = int(np.argmax(pressure.mean(axis=1)))
        if len(gauge.panels) == 1:
            _draw_profile(axes, gauge, pressure[peak])
        else:
            _draw_map(figure, axes, gauge, pressure[peak])
        span = f"{part}, largest force: {time[peak]:.4g} to {time[peak + 1]:.4g} s"
        axes.set_title(span, fontsize="small", loc="left")
        curves = {"mean": pressure.mean(axis=1), "highest panel": pressure.max(axis=1)}
        draw_curves(below, middles, curves)
        below.set_xlabel("time (s)")
        below.set_ylabel(f"{part}: pressure (Pa)")
    grid[1, 0].legend(
        loc="lower right", bbox_to_anchor=(1, 1), ncols=2, frameon=False, fontsize="small",
        borderaxespad=0.2,
    )  # fmt: skip
    return figure


def _draw_profile(axes: Axes, gauge: Panels, pressure: np.ndarray) -> None:
    size = float(gauge.size[0])
    axes.barh(size * (np.arange(len(pressure)) + 0.5), pressure, 0.9 * size, color="C0")
    axes.set_ylim(0, size * len(pressure))
    axes.set_ylabel("along the face (m)")
    axes.set_xlabel("pressure (Pa)")
    axes.grid(alpha=0.3)


def _draw_map(figure: Figure, axes: Axes, gauge: Panels, pressure: np.ndarray) -> None:
    first, second = gauge.panels
    ends = [
        size * np.arange(count + 1) for size, count in zip(gauge.size, gauge.panels, strict=True)
    ]
    mesh = axes.pcolormesh(*ends, pressure.reshape(second, first), cmap="viridis")
    axes.set_aspect("equal", anchor="W")  # its left side is that of the curves below
    axes.set_xlabel("along the first edge (m)")
    axes.set_ylabel("along the second edge (m)")
    beside = axes.inset_axes((1.03, 0.0, 0.04, 1.0))
    figure.colorbar(mesh, cax=beside, label="pressure (Pa)")
