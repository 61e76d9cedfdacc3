"""A map over the shaded relief of its terrain, and a longitudinal profile."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from ...geodata.grid import Raster
from ...measure.maps.quantities import ARRIVAL_TIME, DEPOSIT, PEAK_DEPTH, PEAK_SPEED, MapQuantity
from ..layout import chart_grid, lengths_in_full
from ..nothing import NothingToDrawError
from ..space.ground import hillshade
from .structures import OVER, Structures, draw_structures

LONGEST = 7.0  # inches of the longer side of a map
SHORTEST = 2.5  # inches of the shorter one
LETTERS = 64  # in a line of the title
SIDE = 2.6  # inches beside a map, for its axis and its key
BELOW, LINE = 0.6, 0.22  # inches below a map, and of a line of its title
AROUND = 0.15  # of the extent of the flow, shown around it
LEAST_AROUND = 5.0  # cells
DARKEST = -1.2  # of the grey that stands for no light, below white's 1
HALO = (1.0, 1.0, 1.0, 0.6)  # around numbers, which may lie on structures
CONTOURS = 14  # lines at most
NUMBERS: dict[str, Any] = {"fontsize": "x-small", "fmt": "%g"}  # of contours
NUMBER = 0.25  # inches from bodies to the middle of a number, so that it is beside them
COLOURS = {ARRIVAL_TIME.name: "viridis_r", DEPOSIT.name: "YlOrBr"}
OTHERS = "plasma_r"


def draw_map(
    quantity: MapQuantity,
    values: Raster,
    bed: Raster,
    title: str,
    structures: Structures | None = None,
) -> Figure:
    """One quantity where anything has flowed, over the relief of the bed, at map coordinates.

    Bodies that are fixed on it are drawn, too.

    Raises:
        NothingToDrawError: there is none of it.

    """
    shown = np.isfinite(values.values)
    if quantity != ARRIVAL_TIME:
        shown &= values.values > 0
    if not shown.any():
        raise NothingToDrawError(f"nothing has a {quantity.name.replace('_', ' ')}")
    part = _around(shown)
    bed, values, shown = _part(bed, part), _part(values, part), shown[part]
    west, south, east, north = bed.extent
    title = fill(title, LETTERS)
    figure, axes = _map_axes(east - west, north - south, title.count("\n") + 1)
    extent = (west, east, south, north)
    _draw_bed(axes, bed, extent, structures)
    image = axes.imshow(
        np.where(shown, values.values, np.nan), extent=extent, interpolation="nearest", alpha=0.85,
        cmap=COLOURS.get(quantity.name, OTHERS), zorder=2,
        vmin=None if quantity == ARRIVAL_TIME else 0.0,
    )  # fmt: skip
    label = f"{quantity.label} ({quantity.unit})"
    scale = figure.colorbar(image, ax=axes, label=label, shrink=0.8)
    draw_structures(axes, scale.ax, structures)
    axes.set_title(title, fontsize="medium")
    return figure


def _around(shown: np.ndarray) -> tuple[slice, slice]:
    """The rows and columns where there is anything, and some around it."""
    rows, columns = (np.flatnonzero(shown.any(axis=axis)) for axis in (1, 0))
    longest = max(rows[-1] - rows[0], columns[-1] - columns[0]) + 1
    margin = int(max(AROUND * longest, LEAST_AROUND))
    return (
        slice(max(rows[0] - margin, 0), rows[-1] + margin + 1),
        slice(max(columns[0] - margin, 0), columns[-1] + margin + 1),
    )


def _part(raster: Raster, part: tuple[slice, slice]) -> Raster:
    rows, columns = (s.indices(n) for s, n in zip(part, raster.shape, strict=True))
    return Raster(
        raster.values[part],
        raster.west + columns[0] * raster.cell,
        raster.north - rows[1] * raster.cell,
        raster.cell,
    )


def _map_axes(wide: float, high: float, lines: int) -> tuple[Figure, Axes]:
    """Axes of equal units in a figure of their proportions, with coordinates in full.

    There is room for so many `lines` of a title.
    """
    scale = LONGEST / max(wide, high)
    width, height = (max(side * scale, SHORTEST) for side in (wide, high))
    figure, panels = chart_grid(1, 1, (width + SIDE - 1.5, height + BELOW + LINE * lines), "")
    figure.set_layout_engine("compressed")  # which knows that equal units move what is beside
    axes = panels[0, 0]
    axes.set_aspect("equal")
    lengths_in_full(axes)
    axes.xaxis.set_major_locator(MaxNLocator(max(2, int(width)), steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(max(2, int(1.5 * height)), steps=[1, 2, 5, 10]))
    axes.tick_params(labelsize="small")
    axes.tick_params(axis="x", rotation=30)
    axes.set_xlabel("east (m)")
    axes.set_ylabel("north (m)")
    return figure, axes


def _draw_bed(
    axes: Axes,
    bed: Raster,
    extent: tuple[float, float, float, float],
    structures: Structures | None,
) -> None:
    """Relief lit from the north-west, and contour lines with their heights."""
    axes.set_xlim(extent[:2])
    axes.set_ylim(extent[2:])
    axes.set_facecolor("0.92")
    known = np.isfinite(bed.values)
    if not known.any() or min(bed.shape) < 2:
        return
    axes.imshow(
        np.where(known, hillshade(bed.values, bed.cell), np.nan),
        extent=extent,
        cmap="gray",
        vmin=DARKEST,
        vmax=1.0,
        zorder=1,
    )
    if np.ptp(bed.values[known]) == 0.0:
        return
    levels = MaxNLocator(CONTOURS, steps=[1, 2, 5, 10]).tick_values(
        float(np.nanmin(bed.values)), float(np.nanmax(bed.values))
    )
    lines = axes.contour(
        bed.x, bed.y, bed.values, levels=levels, colors="0.25", linewidths=0.5, zorder=3
    )
    lines.set_in_layout(False)
    _number_contours(axes, lines, bed, structures)


def _number_contours(
    axes: Axes, lines: ContourSet, bed: Raster, structures: Structures | None
) -> None:
    """Heights on contour lines, where these are not hidden by bodies."""
    seen = bed.values
    if structures is not None:
        inch = max(bed.extent[2] - bed.extent[0], bed.extent[3] - bed.extent[1]) / LONGEST
        seen = np.where(structures.near(bed, NUMBER * inch), np.nan, seen)
    # Lines of what is seen tell the places; the numbers stand on those of the whole bed.
    finder = axes.contour(bed.x, bed.y, seen, levels=lines.levels, alpha=0.0)
    places = [label.get_position() for label in axes.clabel(finder, inline=False, **NUMBERS)]
    finder.remove()
    for label in axes.clabel(lines, manual=places, zorder=OVER + 1, **NUMBERS):
        label.set_in_layout(False)  # it lies in the map, and would push it aside
        label.set_path_effects([withStroke(linewidth=1.5, foreground=HALO)])


def draw_profile(profile: Mapping[str, np.ndarray], title: str) -> Figure:
    """The bed along a path, and below it depths and speeds, against the distance."""
    has_bed = bool(np.isfinite(profile["bed"]).any())
    figure, panels = chart_grid(2 + has_bed, 1, (8.0, 2.4), title)
    distance, axes = profile["distance"], list(panels[:, 0])
    if has_bed:
        axes[0].plot(distance, profile["bed"], "k-", linewidth=1.0, label="bed")
        flowed = np.where(profile[PEAK_DEPTH.name] > 0, profile["bed"], np.nan)
        axes[0].plot(distance, flowed, "-", color="tab:red", linewidth=3, alpha=0.6, label="flow")
        axes[0].set_ylabel("height (m)")
        axes[0].legend(frameon=False, fontsize="small")
    depths, speeds = axes[-2:]
    depths.plot(distance, profile[PEAK_DEPTH.name], color="tab:blue", label="largest")
    if np.nansum(profile[DEPOSIT.name]) > 0:
        depths.plot(distance, profile[DEPOSIT.name], color="tab:brown", label="deposit")
    depths.set_ylabel("depth (m)")
    depths.legend(frameon=False, fontsize="small")
    speeds.plot(distance, profile[PEAK_SPEED.name], color="tab:purple")
    speeds.set_ylabel("largest speed (m/s)")
    speeds.set_xlabel("distance along the path (m)")
    for panel in (depths, speeds):
        panel.set_ylim(bottom=0)
    return figure
