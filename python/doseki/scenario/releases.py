"""Releases completed: polygons and thickness read from files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..geodata.crs import same_crs
from ..geodata.errors import GeodataError
from ..geodata.features import Polygon, read_features
from ..geodata.inside import crossing_of
from ..util.spelling import suggestion
from .tables.terrain.release import Release
from .values.toml_source import Where

RASTERS = (".tif", ".tiff", ".asc")
FIELD = "thickness"
OVERLAP = 0.01  # of the smaller of two areas; edges of drawn ones do not meet exactly


def is_raster(file: str | None) -> bool:
    """Whether a release is a raster of thickness."""
    return file is not None and Path(file).suffix.lower() in RASTERS


def completed_release(
    name: str, release: Release, path: Path | None, crs: str | None, where: Where
) -> Release:
    """The release with its polygons and a thickness for each, unless it is a raster.

    `path` is its file, `crs` the coordinate reference system of the terrain.  Raises UserError.
    """
    if release.between is not None or is_raster(release.file):
        if is_raster(release.file) and release.thickness is not None:
            raise where.error(
                ("body", name, "thickness"),
                f"body.{name}.thickness: the raster says how thick it is; give one of the two",
            )
        return release
    found: dict[str, Any] = {"file": None, "digest": None, "polygon": None}
    if path is not None:
        found["polygons"], thickness = _from_file(name, release, path, where, crs)
    else:
        given = release.polygon
        found["polygons"] = [[given]] if given is not None else release.polygons
        thickness = release.thickness
    _check_areas(name, found["polygons"], where)
    count = len(found["polygons"])
    if not isinstance(thickness, list):
        thickness = [thickness] * count
    if len(thickness) != count:
        raise where.error(
            ("body", name, "thickness"),
            f"body.{name}.thickness has {len(thickness)} numbers for {count} polygons",
        )
    return release.model_copy(update=found | {"thickness": thickness})


def _check_areas(name: str, polygons: list[Any], where: Where) -> None:
    """Refuse an outline that crosses itself, and areas that lie in each other."""
    keys = ("body", name)
    areas = []
    for k, rings in enumerate(polygons, 1):
        outlines = [np.array(ring, float) for ring in rings]
        for ring in outlines:
            at = crossing_of(ring)
            if at is not None:
                raise where.error(
                    keys,
                    f"body.{name}: the outline of area {k} crosses itself at "
                    f"{np.round(at, 3).tolist()} m: what is inside cannot be told",
                )
        areas.append(Polygon(outlines[0], tuple(outlines[1:])))
    for k, one in enumerate(areas):
        for j, other in enumerate(areas[:k]):
            shared = one.shared_with(other)
            if shared > OVERLAP * min(one.area, other.area):
                raise where.error(
                    keys,
                    f"body.{name}: areas {j + 1} and {k + 1} share {shared:.3g} m2, where "
                    "particles of both would be: cut one of them, or make one area of both",
                )


def _from_file(
    name: str, release: Release, path: Path, where: Where, crs: str | None
) -> tuple[Any, Any]:
    """Polygons as lists of rings, and the thickness given or of each."""
    keys, place = ("body", name, "file"), f"body.{name}.file"
    try:
        features = read_features(path)
    except GeodataError as error:
        raise where.error(keys, f"{place}: {error}") from None
    if same_crs(features.crs, crs) is False:
        raise where.error(
            keys,
            f"{place}: {path} and the terrain have different coordinate reference systems; convert "
            "it with ogr2ogr -t_srs",
        )
    if not features.polygons:
        raise where.error(keys, f"{place}: {path} has no polygon")
    polygons = [[ring.tolist() for ring in each.rings] for each in features.polygons]
    if release.thickness is not None:
        return polygons, release.thickness
    thickness = []
    for polygon in features.polygons:
        if FIELD not in polygon.attributes:
            like = suggestion(FIELD, polygon.attributes)
            raise where.error(
                keys,
                f"{place}: a polygon of {path} has no attribute {FIELD}, in m: add it, or give "
                f"body.{name}.thickness{like}",
            )
        number = polygon.attributes[FIELD]
        if not isinstance(number, int | float) or not 0 < number < np.inf:
            raise where.error(
                keys,
                f"{place}: a polygon of {path} has {FIELD} = {number!r}, not a length in m above "
                f"0; give body.{name}.thickness",
            )
        thickness.append(float(number))
    return polygons, thickness
