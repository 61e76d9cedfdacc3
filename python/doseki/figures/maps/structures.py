"""Fixed bodies that stand on a terrain, as a map shows them: dams and buildings from above."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ...geodata.raster import Raster
from ...measure.maps.standing import KEYS, clamped_bodies, standing
from ...record.reader import Run
from ..space.ground import terrain_of

COLOUR, EDGE = "0.0", "white"  # no slope is black, nor is any flow
LABEL = "fixed bodies"
ACROSS = 800  # nodes along the longer side of a map, at most
BETWEEN = 4  # nodes in a spacing, where there is room for them
OVER = 6  # contour lines and their numbers


@dataclass(frozen=True)
class Structures:
    """Places (n, 2) of particles of fixed bodies above the ground, and their spacing, m."""

    place: np.ndarray
    spacing: float

    @classmethod
    def of(cls, run: Run) -> Structures | None:
        """Those of a run on a terrain; None without a terrain, or where nothing stands on it."""
        if terrain_of(run) is None or not len(run):
            return None
        assert isinstance(run.ground, Raster)
        snapshot = run[0]
        clamped = clamped_bodies(snapshot.body_names, run.scenario.get("body", {}))
        stands = standing({key: snapshot.stored(key) for key in KEYS}, clamped)
        chosen = (snapshot["fixed"] & (snapshot["body"] != terrain_of(run))) | stands
        position = snapshot["position"][chosen]
        # Where the map knows nothing of the ground a body stands on it, too.
        out = ~(position[:, 2] <= run.ground.sampled(position[:, 0], position[:, 1]))
        if not out.any():
            return None
        volume = (snapshot["mass"] / snapshot["density"])[chosen][out]
        return cls(position[out, :2], float(np.cbrt(volume.max())))

    def near(self, grid: Raster, distance: float) -> np.ndarray:
        """Mask of the cells of a grid whose middles are in a body, or within a distance, m."""
        from scipy.spatial import cKDTree

        middles = np.stack(np.meshgrid(grid.x, grid.y), axis=-1)
        reach = distance + 0.5 * self.spacing
        found = cKDTree(self.place).query(middles, distance_upper_bound=reach)[0]
        return np.asarray(np.isfinite(found))

    @classmethod
    def of_all(cls, runs: Sequence[Run]) -> Structures | None:
        """Those of runs whose tables of fixed bodies are the same; else None."""
        if terrain_of(runs[0]) is None:
            return None
        tables = [_fixed_tables(run) for run in runs]
        return cls.of(runs[0]) if all(table == tables[0] for table in tables) else None


def _fixed_tables(run: Run) -> dict[str, Any]:
    tables = run.scenario.get("body", {})
    return {n: table for n, table in tables.items() if table.get("fixed") or "clamped" in table}


def draw_structures(axes: Axes, scale: Axes, structures: Structures | None) -> None:
    """Fill what of them is within the limits of a map, with a word in the corner below `scale`."""
    if structures is None:
        return
    west, east, south, north = *axes.get_xlim(), *axes.get_ylim()
    margin = structures.spacing
    low, high = np.array([west, south]) - margin, np.array([east, north]) + margin
    place = structures.place[((structures.place > low) & (structures.place < high)).all(axis=1)]
    if not len(place):
        return
    step = max(structures.spacing / BETWEEN, max(east - west, north - south) / ACROSS)
    x, y, depth = _depths(place, structures.spacing, step)
    outline = [0.0]
    axes.contourf(x, y, depth, levels=[*outline, np.inf], colors=[COLOUR], zorder=OVER)
    axes.contour(x, y, depth, levels=outline, colors=EDGE, linewidths=1.0, zorder=OVER)
    key = axes.legend(
        handles=[Patch(facecolor=COLOUR, edgecolor=EDGE, label=LABEL)], loc="lower right",
        bbox_to_anchor=(1.0, 0.0), bbox_transform=scale.figure.transFigure, frameon=False,
        fontsize="small", handlelength=1.2, borderpad=0.0, borderaxespad=0.3,
    )  # fmt: skip
    key.set_in_layout(False)  # it would push the map aside


def _depths(
    place: np.ndarray, spacing: float, step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How deep nodes are in what particles at places (n, 2) cover, m; below 0 outside.

    Nodes along x and y, `step` apart, and depths (len(y), len(x)).  Discs that overlap are made
    smaller again together, so that the edge of a lattice is a line, whatever its direction.
    """
    from scipy.ndimage import distance_transform_edt
    from scipy.spatial import cKDTree

    reach = max(spacing, 2 * step)
    low, high = place.min(axis=0) - reach - step, place.max(axis=0) + reach + step
    x, y = (np.arange(a, b + step, step) for a, b in zip(low, high, strict=True))
    nodes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    near = np.isfinite(cKDTree(place).query(nodes, distance_upper_bound=reach)[0])
    inside = distance_transform_edt(near.reshape(len(y), len(x))) * step
    return x, y, inside - (reach - max(spacing / 2, step))
