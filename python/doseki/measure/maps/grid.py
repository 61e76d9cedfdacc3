"""The cells that are mapped: those of the terrain, coarser ones, or a grid of the user's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import UserError
from ...geodata.errors import GeodataError
from ...geodata.grid import MAX_CELLS, TOLERANCE, Raster
from ...geodata.raster import read_raster
from ...record.folder import RunFolder

SPEED_DEPOSIT = 0.1  # m/s, below which matter has come to rest
MIN_DEPTH = 0.5  # spacings, below which a cell counts as dry
FEW = 2.0  # spacings; in smaller cells depths are those of single particles


@dataclass(frozen=True)
class MapSettings:
    """How a flow is mapped, SI units.

    Attributes:
        dp: particle spacing.
        cell: side of cells; None takes those of the terrain.
        extent: west, south, east, north; None takes all of the terrain.
        min_depth: below which a cell counts as dry.
        speed_deposit: below which matter has come to rest.
        named: what stands before `cell` and `extent` where the user gives them.

    """

    dp: float
    cell: float | None = None
    extent: Sequence[float] | None = None
    min_depth: float | None = None
    speed_deposit: float = SPEED_DEPOSIT
    named: str = "maps."

    @classmethod
    def of(cls, table: Mapping[str, Any] | None, dp: float) -> MapSettings:
        """Of the table [maps] of a scenario, or the defaults where it has none."""
        names = ("cell", "extent", "min_depth", "speed_deposit")
        given = {name: (table or {}).get(name) for name in names}
        return cls(dp, **{name: value for name, value in given.items() if value is not None})

    @property
    def dry_below(self) -> float:
        """Depth, m, below which a cell counts as dry."""
        return MIN_DEPTH * self.dp if self.min_depth is None else self.min_depth


def map_grid(folder: RunFolder, settings: MapSettings) -> Raster:
    """The cells to map, with the height of the bed (NaN where the run has no terrain).

    Raises:
        UserError: the run has no terrain and no grid is given, cells do not fit those of the
            terrain, or are smaller than particles.

    """
    path = folder.terrain
    try:
        _check_extent(settings)
        if path is None and (settings.cell is None or settings.extent is None):
            raise GeodataError(
                f"{folder.path} has no terrain; give {settings.named}extent (west, south, east, "
                f"north) and {settings.named}cell, m"
            )
        grid = cells_of(None if path is None else read_raster(path), settings)
    except GeodataError as error:
        place = "maps: " if settings.named == MapSettings.named else ""
        raise UserError(f"{place}{error}") from None
    if grid.cell < settings.dp * (1 - TOLERANCE):
        raise UserError(
            f"cells of {grid.cell:g} m are smaller than a particle (dp = {settings.dp:g} m); "
            f"give {settings.named}cell of {FEW:g} dp or more"
        )
    return grid


def _check_extent(settings: MapSettings) -> None:
    if settings.extent is None:
        return
    west, south, east, north = settings.extent
    if not (np.isfinite(settings.extent).all() and west < east and south < north):
        raise GeodataError("the extent must be west, south, east, north with west < east and so on")


def cells_of(ground: Raster | None, settings: MapSettings) -> Raster:
    """The cells to map; without a ground the settings must have both cell and extent.

    Raises:
        GeodataError: they do not fit those of the ground, or are too many.

    """
    if ground is not None:
        return ground.for_maps(settings.cell, settings.extent, f"{settings.named}cell")
    assert settings.cell is not None
    assert settings.extent is not None
    west, south, east, north = settings.extent
    shape = [
        int(np.ceil(min(length / settings.cell - TOLERANCE, 1e12)))
        for length in (north - south, east - west)
    ]
    if shape[0] * shape[1] > MAX_CELLS:
        raise GeodataError(
            f"maps.extent has {shape[0] * shape[1]:.3g} cells; at most {MAX_CELLS:.3g}"
        )
    return Raster(np.full(shape, np.nan), west, south, settings.cell)


def few_particles(grid: Raster, dp: float, named: str = MapSettings.named) -> str | None:
    """A warning about small cells; None where there is no need of one.

    `named` is that of MapSettings.
    """
    if grid.cell >= FEW * dp * (1 - TOLERANCE):
        return None
    return (
        f"cells of {grid.cell:g} m are smaller than {FEW:g} particles (dp = {dp:g} m), so depths "
        f"are rough; {named}cell = {FEW * dp:g} or more would do"
    )
