"""The ground of a run on a terrain: below the flow in 2-D, a surface around it in 3-D."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource

from ...geodata.ground import Profile
from ...geodata.raster import Raster
from ...measure.views import View
from ...record.reader import Run, Snapshot
from ...scenario.tables.terrain.terrain import TERRAIN
from ..layout import Extent
from .box import Space
from .surfaces import NOTHING, Background, Camera, picture_shape, seen_balls

COLOUR = "#b3ada3"
SPACE_COLOUR = np.array([0.95, 0.94, 0.88])  # lighter than what stands on it
SUN = {"azdeg": 315.0, "altdeg": 45.0}
TO_THE_SUN = np.array([-0.5, 0.5, np.sqrt(0.5)])
DARKEST = 0.62  # grey of what faces away from the sun
AROUND = 0.3  # of the size of the flow: beyond the structures that are shown
ACROSS = 360  # points of the ground along the longer side of what is drawn


def draw_ground(axes: Axes, run: Run, view: View, extent: Extent) -> None:
    """Fill what lies below the profile of a 2-D run; nothing where it has none."""
    if not isinstance(run.ground, Profile):
        return
    x, z = run.ground.x, run.ground.z
    below = min(float(z.min()), extent[2]) - (extent[3] - extent[2])
    outline = np.array([[x[0], below], *zip(x, z, strict=True), [x[-1], below]])
    corners = view.coordinates(outline)
    axes.fill(corners[:, 0], corners[:, 1], color=COLOUR, linewidth=0, zorder=0)


def terrain_of(run: Run) -> str | None:
    """The body that a map makes the ground of a 3-D run; None without one."""
    return TERRAIN if isinstance(run.ground, Raster) else None


def space_of(run: Run, snapshots: Sequence[Snapshot], view: View) -> Space:
    """What of a 3-D run is drawn at some moments; on a terrain what is in the ground is not.

    Raises NothingToDrawError where there is no particle at any of them.
    """
    ground = run.ground if isinstance(run.ground, Raster) else None
    return Space.around(snapshots, view, terrain_of(run), ground)


def relief(run: Run, extent: Extent, width: int) -> np.ndarray | None:
    """The terrain from above, (rows, `width`, 3) from 0 to 1, lit from the north-west.

    It is light, so that colours of what lies on it can be told; None without a terrain.
    """
    if not isinstance(run.ground, Raster):
        return None
    rows, columns = picture_shape(extent, width)
    pixel = (extent[1] - extent[0]) / columns
    x = extent[0] + pixel * (np.arange(columns) + 0.5)
    y = extent[3] - pixel * (np.arange(rows) + 0.5)
    height = run.ground.sampled(*np.meshgrid(x, y))
    known = ~np.isnan(height)
    picture = np.ones((rows, columns, 3))
    if known.any() and min(rows, columns) > 1:
        shade = DARKEST + (1.0 - DARKEST) * hillshade(height, pixel)
        picture[known] = shade[known, None]
    return picture


def hillshade(height: np.ndarray, cell: float) -> np.ndarray:
    """Heights (rows, columns), m, rows from the north, lit from the north-west: from 0 to 1.

    It means nothing where a height is unknown, and beside it slopes are those on the other side, so
    that the edge of what is known is no cliff.  One height is known or more.
    """
    known = np.isfinite(height)
    south, east = (_slope(height, cell, axis) for axis in (0, 1))
    normal = np.stack([-east, south, np.ones(height.shape)], axis=-1)
    normal[~known] = normal[known][0]  # so that it is neither the brightest nor the darkest place
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.asarray(LightSource(**SUN).shade_normals(normal))


def _slope(height: np.ndarray, cell: float, axis: int) -> np.ndarray:
    """Rise along an axis of the rows or columns: the mean of both sides, as far as they are known.

    It is 0 where neither is.
    """
    step = np.diff(height, axis=axis) / cell
    around = [(1, 1) if axis == k else (0, 0) for k in range(2)]
    step = np.pad(step, around, constant_values=np.nan)
    before, after = np.delete(step, -1, axis), np.delete(step, 0, axis)
    sides = np.isfinite(before).astype(int) + np.isfinite(after)
    return np.asarray((np.nan_to_num(before) + np.nan_to_num(after)) / np.maximum(sides, 1))


def ground_behind(
    run: Run, space: Space, camera: Camera, extent: Extent, width: int
) -> Background | None:
    """The surface of a terrain around what is drawn, as a camera sees it; None without one."""
    if not isinstance(run.ground, Raster):
        return None
    shape = picture_shape(extent, width)
    pixel = (extent[1] - extent[0]) / shape[1]
    shown, depth = seen_balls(*_balls_below(run.ground, space), camera, extent, shape)
    row, column = np.nonzero(shown != NOTHING)
    right = extent[0] + pixel * (column + 0.5)
    up = extent[3] - pixel * (row + 0.5)
    place = np.outer(right, camera.right) + np.outer(up, camera.up)
    place += np.outer(pixel * depth[row, column], camera.away)
    picture = np.ones((*shape, 3))
    shade = _shade(run.ground, place[:, 0], place[:, 1], pixel)
    picture[row, column] = SPACE_COLOUR * (DARKEST + (1.0 - DARKEST) * shade)[:, None]
    return Background(picture, depth)


def _balls_below(ground: Raster, space: Space) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and radii (n,) of balls whose tops are at the surface."""
    room = AROUND * float(np.max(space.high - space.low))
    low, high = (space.low - room)[:2], (space.high + room)[:2]
    step = float(np.max(high - low)) / ACROSS
    x, y = (np.arange(a, b, step) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    height = ground.sampled(grid[:, 0], grid[:, 1])
    known = ~np.isnan(height)
    # On a slope a ball must reach its neighbours.
    position = np.column_stack([grid, height])[known] - [0.0, 0.0, 1.5 * step]
    return position, np.full(len(position), 1.5 * step)


def _shade(ground: Raster, x: np.ndarray, y: np.ndarray, step: float) -> np.ndarray:
    """How bright the sun makes the ground at places (n,), from 0 to 1, by its slope there."""
    slopes = [
        np.nan_to_num(ground.sampled(x + dx, y + dy) - ground.sampled(x - dx, y - dy)) / (2 * step)
        for dx, dy in ((step, 0.0), (0.0, step))
    ]
    normal = np.stack([-slopes[0], -slopes[1], np.ones(len(x))], axis=1)
    bright = normal @ TO_THE_SUN / np.linalg.norm(normal, axis=1)
    least, most = (bright.min(), bright.max()) if len(bright) else (0.0, 0.0)
    return np.asarray((bright - least) / (most - least)) if most > least else np.ones(len(x))
