"""Shapefiles and GeoPackages, by pyogrio (GDAL) and shapely."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..util.foreign import open_regular, readable
from .crs import check_map_coordinates
from .errors import GeodataError, needed
from .outlines import Features, Line, Polygon
from .shapes import line_of, polygon_of

# What a file of each kind begins with: GDAL would take others for what they say themselves.
MAGIC = {".shp": b"\x00\x00\x27\x0a", ".gpkg": b"SQLite format 3\x00"}
WHAT = {".shp": "a shapefile", ".gpkg": "a GeoPackage"}
DRAWN = ("Polygon", "MultiPolygon", "LineString", "MultiLineString")


def read_vector_file(path: Path, layer: str | None) -> Features:
    """Polygons and lines of a file, or of one layer of it.

    Raises:
        GeodataError: it is damaged, holds something else, has several layers and none was chosen,
            or pyogrio or shapely is missing.
        UserError: it cannot be read.

    """
    suffix = path.suffix.lower()
    pyogrio, shapely = (needed(name, path, WHAT[suffix]) for name in ("pyogrio.raw", "shapely"))
    with open_regular(path) as (file, _):
        if not file.read(len(MAGIC[suffix])) == MAGIC[suffix]:
            raise GeodataError(f"{path}: is not {WHAT[suffix]}")
    with warnings.catch_warnings(), readable(path, kind=WHAT[suffix]):
        warnings.simplefilter("ignore")  # of measures (M) of vertices, which nothing here needs
        layer = _layer(path, layer)
        about, _, shapes, columns = pyogrio.read(path, layer=layer)
        geometries = shapely.from_wkb(shapes)
    crs = about["crs"]
    if crs is not None:
        check_map_coordinates(path, crs)
    rows = [
        dict(zip(about["fields"], map(_plain, row), strict=True))
        for row in zip(*columns, strict=True)
    ]
    rows = rows or [{} for _ in geometries]
    found = [
        shape
        for number, (geometry, row) in enumerate(zip(geometries, rows, strict=True), 1)
        for shape in _shapes(f"{path}, feature {number}", geometry, row)
    ]
    polygons = tuple(shape for shape in found if isinstance(shape, Polygon))
    return Features(polygons, tuple(shape for shape in found if isinstance(shape, Line)), crs)


def _layer(path: Path, layer: str | None) -> str:
    """The layer that is meant; raises GeodataError where that is not clear."""
    import pyogrio

    # Tables of styles and attributes that programs keep in the same file have no geometry.
    names = [str(name) for name, geometry, *_ in pyogrio.list_layers(path) if geometry is not None]
    if layer is None and len(names) == 1:
        return names[0]
    if layer not in names:
        those = ", ".join(names)
        if layer is not None or not names:
            what = f'no layer "{layer}"' if names else "no layer of areas or lines"
            raise GeodataError(f"{path}: {what}{f'; it has {those}' if names else ''}")
        raise GeodataError(
            f"{path}: has the layers {those}, and one is read; write it into a file of its own: "
            f"ogr2ogr NEW.gpkg {path.name} LAYER"
        )
    return str(layer)


def _plain(value: Any) -> Any:
    """A number, text or truth of Python; None where a table has nothing."""
    value = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(value, float) and math.isnan(value) else value


def _shapes(where: str, geometry: Any, attributes: dict[str, Any]) -> Iterator[Polygon | Line]:
    """The polygons or lines of one feature."""
    if geometry is None or geometry.is_empty:
        raise GeodataError(f"{where}: no geometry; draw its area or line, or take the feature out")
    kind = geometry.geom_type
    if kind not in DRAWN:
        raise GeodataError(f"{where}: {kind} is not read; {', '.join(DRAWN)} are")
    for part in getattr(geometry, "geoms", [geometry]):
        if kind.endswith("Polygon"):
            rings = [list(ring.coords) for ring in (part.exterior, *part.interiors)]
            yield polygon_of(where, rings, attributes)
        else:
            yield line_of(where, list(part.coords), attributes)
