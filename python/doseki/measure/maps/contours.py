"""Lines of equal depth on a map, as features for geographic programs."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from contourpy import contour_generator

from ...geodata.crs import epsg_code
from ...geodata.grid import Raster
from ...record.writer import jsonable
from ...util.files import write_whole_text
from .quantities import MapQuantity

MOST = 8  # round levels


def levels_of(raster: Raster, least: float) -> list[float]:
    """`least`, and round levels between it and the largest value."""
    largest = float(np.nanmax(raster.values, initial=0.0))
    if largest <= least:
        return []
    coarse = largest / MOST
    power = 10.0 ** math.floor(math.log10(coarse))
    step = next(times * power for times in (1, 2, 5, 10) if times * power >= coarse)
    ticks = [round(k * step, 12) for k in range(1, MOST + 1)]
    return [least, *(level for level in ticks if least < level < largest)]


def contours(raster: Raster, levels: Sequence[float]) -> list[dict[str, Any]]:
    """A GeoJSON feature for each level that is reached: all its lines, in map coordinates.

    Lines pass between the centres of cells; around the grid it is dry, so that they are closed.
    """
    values = np.pad(np.nan_to_num(raster.values), 1)
    x = raster.west + raster.cell * (np.arange(values.shape[1]) - 0.5)
    y = raster.north - raster.cell * (np.arange(values.shape[0]) - 0.5)
    generator = contour_generator(x, y, values)
    found = []
    for level in levels:
        lines = [np.asarray(line).tolist() for line in generator.lines(level) if len(line) > 1]
        if lines:
            shape = {"type": "MultiLineString", "coordinates": lines}
            found.append({"type": "Feature", "properties": {"level": level}, "geometry": shape})
    return found


def write_contours(path: Path, raster: Raster, quantity: MapQuantity, least: float) -> None:
    """Write the contours of a map as GeoJSON in its coordinates; `least` is the lowest level."""
    features = contours(raster, levels_of(raster, least))
    for feature in features:
        feature["properties"] |= {"quantity": quantity.name, "unit": quantity.unit}
    table: dict[str, Any] = {"type": "FeatureCollection", "name": path.stem, "features": features}
    if (code := epsg_code(raster.crs)) is not None:
        name = f"urn:ogc:def:crs:EPSG::{code}"
        table["crs"] = {"type": "name", "properties": {"name": name}}
    write_whole_text(path, json.dumps(jsonable(table)) + "\n")
