"""Checks of [maps] against the rest of a scenario."""

from __future__ import annotations

from ...geodata.errors import GeodataError
from ..model import Scenario

MAX_LOOKS = 1e6


def check_maps(scenario: Scenario) -> None:
    """Raise UserError for maps that would be looked at too often, or of cells that do not fit."""
    maps = scenario.maps
    if maps is None:
        return
    if getattr(scenario, "terrain", None) is None:
        for key in ("extent", "cell"):
            if getattr(maps, key) is None:
                raise scenario.where.error(
                    ("maps",),
                    f"maps.{key} is missing: the run has no terrain whose grid it could be",
                )
    if maps.interval is not None and scenario.time_max / maps.interval > MAX_LOOKS:
        raise scenario.where.error(
            ("maps", "interval"),
            f"maps.interval = {maps.interval:g} s is too short for time_max = "
            f"{scenario.time_max:g} s; at most {MAX_LOOKS:g} looks are taken",
        )
    if maps.cell is not None and maps.cell < scenario.dp:
        raise scenario.where.error(
            ("maps", "cell"),
            f"maps.cell = {maps.cell:g} m is smaller than a particle (dp = {scenario.dp:g} m)",
        )
    if scenario.bed is not None and scenario.bed.raster is not None:
        try:
            scenario.bed.raster.for_maps(maps.cell, maps.extent)
        except GeodataError as error:
            raise scenario.where.error(("maps",), f"maps: {error}") from None
