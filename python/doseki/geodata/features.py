"""Polygons and lines read from GeoJSON, and from shapefiles and GeoPackages.

GeoJSON (RFC 7946, and its older `crs` member) is read without other packages, the others with the
extra `terrain`.
"""

from __future__ import annotations

from pathlib import Path

from ..util.foreign import check_regular_file
from .crs import check_same_crs
from .errors import GeodataError
from .geojson import read_geojson
from .outlines import Features, Line, Polygon
from .vector_files import read_vector_file

__all__ = ["Features", "Line", "Polygon", "read_features", "read_on_map"]


def read_features(path: Path | str, layer: str | None = None) -> Features:
    """Polygons and lines of a file: .geojson or .json, .shp, .gpkg.

    `layer` chooses one of several in a GeoPackage.

    Raises:
        GeodataError: it is damaged, holds points or nothing, is not in metres, or a package is
            missing.
        UserError: it cannot be read.

    """
    path = Path(path)
    check_regular_file(path)
    suffix = path.suffix.lower()
    if suffix in (".geojson", ".json"):
        found = read_geojson(path)
    elif suffix in (".shp", ".gpkg"):
        found = read_vector_file(path, layer)
    else:
        raise GeodataError(f"{path}: features are read from .geojson, .shp or .gpkg")
    if not (found.polygons or found.lines):
        raise GeodataError(f"{path}: holds neither polygons nor lines")
    return found


def read_on_map(path: Path | str, crs: str | None) -> Features:
    """The same of a file whose features lie on the map of a terrain in the system `crs`.

    Raises GeodataError too where it is in another coordinate reference system, as far as is known.
    """
    found = read_features(path)
    check_same_crs(path, found.crs, crs)
    return found
