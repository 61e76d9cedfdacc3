"""Particles as dots that are true to scale: which ones a view shows, and drawing them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection

from ..measure.views import View
from ..record.reader import Snapshot
from ..scenario.schemes import SUPPORT
from .colouring import Colouring
from .layout import Extent
from .raster import coloured, splat

MARGIN = 0.02  # of the size of the picture, around all particles
FEW_CIRCLES = 100
MAX_CIRCLES = 200_000  # more particles than this are drawn as pixels
RASTER_WIDTH = 2000
STRAY = 0.5  # per cent of what moves, at each end, that may be far from all others
NEAR = 0.1  # of the size of a flow: what is no farther away belongs to it
ROOM = 0.15  # of the size of the flow, around it, in which walls are shown
WHITE = (255, 255, 255)


@dataclass(frozen=True)
class Dots:
    """The particles of a snapshot that a view shows: indices (n,), points (n, 2), radii (n,)."""

    index: np.ndarray
    points: np.ndarray
    radius: np.ndarray


def dots(snapshot: Snapshot, view: View, size: str = "grain", material: str | None = None) -> Dots:
    """The particles to draw, in order: fixed ones, then light before heavy (rock over water).

    In 3-D they are those of a thin slice along x and z.
    With `material` only the particles of that material.

    `size` is "grain" (a circle has the area, a sphere the volume, of the particle) or "support"
    (its radius is H h, as in the figures of the paper).
    """
    position = view.coordinates(snapshot["position"])
    index = drawing_order(snapshot, _in_slice(position, snapshot, view), material)
    radius = SUPPORT * snapshot["smoothing_length"] if size == "support" else grain_radius(snapshot)
    return Dots(index, position[index][:, [0, -1]], radius[index])


def drawing_order(snapshot: Snapshot, shown: np.ndarray, material: str | None) -> np.ndarray:
    """Indices (n,) of the particles `shown` (N,), of one material where it is given, see `dots`."""
    if material is not None:
        shown = shown & (snapshot["material"] == material)
    index = np.flatnonzero(shown)
    return np.asarray(index[np.lexsort((snapshot["density"][index], ~snapshot["fixed"][index]))])


def grain_radius(snapshot: Snapshot) -> np.ndarray:
    """Radius (N,) of the circle, or ball, that has the volume of each particle, m."""
    volume = snapshot["mass"] / snapshot["density"]
    if snapshot.dim == 2:
        return np.sqrt(volume / np.pi)
    return np.cbrt(3 * volume / (4 * np.pi))


def _in_slice(position: np.ndarray, snapshot: Snapshot, view: View) -> np.ndarray:
    """In 3-D: near the middle of the view, or of all where the view has no bounds."""
    if snapshot.dim == 2 or len(position) == 0:
        return np.ones(len(position), bool)
    across = position[:, 1]
    ends = np.clip([across.min(), across.max()], view.lower[1], view.upper[1])
    middle = ends.mean()
    spacing = np.cbrt(snapshot["mass"] / snapshot["density"])
    return np.abs(across - middle) <= 0.75 * spacing


def extent_of(snapshots: Sequence[Snapshot], view: View, size: str = "grain") -> Extent:
    """The bounds of the view; where these are infinite, what holds what moves, and walls nearby.

    Drops that fly far from all others are left out.
    """
    shown = [(s, d) for s, d in ((s, dots(s, view, size)) for s in snapshots) if len(d.index)]
    low, high = view.lower[[0, -1]], view.upper[[0, -1]]
    if shown:
        ends = _ends([(d.points, s["fixed"][d.index]) for s, d in shown])
        margin = max(d.radius.max() for _, d in shown) + MARGIN * np.max(ends[1] - ends[0])
        low = np.where(np.isfinite(low), low, ends[0] - margin)
        high = np.where(np.isfinite(high), high, ends[1] + margin)
    low, high = np.where(np.isfinite(low), low, 0.0), np.where(np.isfinite(high), high, 1.0)
    return low[0], high[0], low[1], high[1]


def _ends(clouds: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest coordinates of points (n, 2), of which some are fixed (n,)."""
    walls = np.concatenate([points[fixed] for points, fixed in clouds])
    free = [points[~fixed] for points, fixed in clouds if not fixed.all()]
    if not free:
        return walls.min(axis=0), walls.max(axis=0)
    low, high = ends_of_clouds(free)
    if len(walls):
        room = ROOM * np.max(high - low)
        low = np.minimum(low, np.maximum(walls.min(axis=0), low - room))
        high = np.maximum(high, np.minimum(walls.max(axis=0), high + room))
    return low, high


def ends_of_clouds(clouds: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest coordinates of most points of each cloud (n, k); there is one or more."""
    low, high = zip(*(ends_of_most(points) for points in clouds), strict=True)
    return np.min(low, axis=0), np.max(high, axis=0)


def ends_of_most(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest coordinates, without the few points that are far from all others."""
    low, high = np.percentile(points, (STRAY, 100 - STRAY), axis=0)
    near = NEAR * np.max(high - low)
    least, greatest = points.min(axis=0), points.max(axis=0)
    return (
        np.where(least > low - near, least, low),
        np.where(greatest < high + near, greatest, high),
    )


def outside_text(snapshot: Snapshot, view: View, shown: Dots, extent: Extent) -> str:
    """How many of the particles that move a picture of everything leaves out."""
    if np.isfinite(view.lower).any() or np.isfinite(view.upper).any():
        return ""
    points = shown.points[~snapshot["fixed"][shown.index]]
    left, right, bottom, top = extent
    low, high = np.array([left, bottom]), np.array([right, top])
    beyond = int(np.any((points < low) | (points > high), axis=1).sum())
    return f" ({beyond} of {len(points)} particles are outside)" if beyond else ""


def draw_particles(
    axes: Axes, snapshot: Snapshot, shown: Dots, colours: Colouring, extent: Extent
) -> None:
    """Draw the dots in data units: circles, or pixels when there are very many."""
    rgba = colours.rgba(snapshot)[shown.index]
    if len(shown.index) > MAX_CIRCLES:
        axes.imshow(
            picture(shown, rgba, extent, RASTER_WIDTH), extent=extent, interpolation="nearest"
        )
    else:
        axes.add_collection(_circles(axes, shown, rgba))
    axes.set(xlim=extent[:2], ylim=extent[2:], aspect="equal")


def picture(shown: Dots, rgba: np.ndarray, extent: Extent, width: int) -> np.ndarray:
    """The dots as pixels (rows, `width`, 3) uint8 on white; `rgba` (n, 4) is from 0 to 1."""
    rgb = np.round(255 * rgba[:, :3]).astype(np.uint8)
    return coloured(splat(shown.points, shown.radius, extent, width), rgb, WHITE)


def _circles(axes: Axes, shown: Dots, rgba: np.ndarray) -> EllipseCollection:
    few = len(shown.index) <= FEW_CIRCLES  # then circles that overlap shine through
    return EllipseCollection(
        2 * shown.radius, 2 * shown.radius, np.zeros(len(shown.index)), units="xy",
        offsets=shown.points, offset_transform=axes.transData, facecolors=rgba,
        edgecolors="black" if few else "none", linewidths=0.5, alpha=0.8 if few else 1.0,
    )  # fmt: skip
