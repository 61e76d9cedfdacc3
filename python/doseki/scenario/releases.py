"""Releases completed: polygons and thickness read from files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UserError
from ..geodata.crs import not_compared_text, same_crs, why_not_compared
from ..geodata.features import Features, Polygon, read_features
from ..geodata.inside import crossing_of
from ..geodata.raster import holds_raster
from ..util.finding import Finding
from ..util.spelling import suggestion
from .tables.terrain.release import THICKEST, Release
from .values.toml_source import Where

FIELD = "thickness"
OVERLAP = 0.01  # of the smaller of two areas; edges of drawn ones do not meet exactly


@dataclass(frozen=True)
class NotCompared(Finding):
    """A file whose coordinate reference system could not be compared with that of the terrain."""

    file: Path
    why: str

    def __str__(self) -> str:
        return f"{self.place}: {not_compared_text(self.file, self.why)}"


def completed_release(
    name: str, release: Release, path: Path | None, crs: str | None, where: Where
) -> tuple[Release, list[Finding]]:
    """The release with its polygons and a thickness for each, unless it is a raster; and doubts.

    `path` is its file, `crs` the coordinate reference system of the terrain.  Raises UserError.
    """
    doubts: list[Finding] = []
    is_raster = path is not None and _is_raster(name, path, where)
    if release.between is not None or is_raster:
        if is_raster and release.thickness is not None:
            raise where.error(
                ("body", name, "thickness"),
                f"body.{name}.thickness: the raster says how thick it is; give one of the two",
            )
        return release, doubts
    found: dict[str, Any] = {"file": None, "digest": None, "polygon": None}
    if path is not None:
        features = _read(name, path, where, crs)
        if why := why_not_compared(features.crs, crs):
            doubts.append(NotCompared(f"body.{name}.file", path, why))
        found["polygons"], thickness = _from_file(name, release, path, where, features)
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
            f"body.{name}.thickness has {_counted(len(thickness), 'number')} for "
            f"{_counted(count, 'polygon')}",
        )
    return release.model_copy(update=found | {"thickness": thickness}), doubts


def _counted(count: int, thing: str) -> str:
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _check_areas(name: str, polygons: list[Any], where: Where) -> None:
    """Refuse rings that do not make an area, and areas that lie in each other."""
    keys = ("body", name)
    areas = []
    for k, rings in enumerate(polygons, 1):
        outer, *holes = (np.array(ring, float) for ring in rings)
        areas.append(Polygon(outer, tuple(holes)))
        if wrong := _wrong_ring(areas[-1], f"area {k}"):
            raise where.error(keys, f"body.{name}: {wrong}")
    for k, one in enumerate(areas):
        for j, other in enumerate(areas[:k]):
            shared = one.shared_with(other)
            if shared > OVERLAP * min(one.area, other.area):
                raise where.error(
                    keys,
                    f"body.{name}: areas {j + 1} and {k + 1} share {shared:.3g} m2, where "
                    "particles of both would be: cut one of them, or make one area of both",
                )


def _wrong_ring(area: Polygon, name: str) -> str | None:
    """What is wrong with the outline of an area or with one of its holes."""
    for k, ring in enumerate(area.rings):
        at = crossing_of(ring)
        if at is not None:
            return (
                f"{f'hole {k}' if k else 'the outline'} of {name} crosses itself at "
                f"{np.round(at, 3).tolist()} m: what is inside cannot be told"
            )
    outline, *holes = (Polygon(ring) for ring in area.rings)
    for k, hole in enumerate(holes):
        outside = 1 - hole.share_within(outline)
        if outside > OVERLAP:
            return (
                f"{100 * outside:.0f} % of hole {k + 1} of {name} lie outside its outline, where "
                "there is nothing to leave out: cut the hole at the outline, or remove it"
            )
        for j, other in enumerate(holes[:k]):
            shared = hole.shared_with(other)
            if shared > OVERLAP * min(hole.area, other.area):
                return (
                    f"holes {j + 1} and {k + 1} of {name} share {shared:.3g} m2, which would be "
                    "left out twice: make one hole of both, or remove one"
                )
    return None


def _is_raster(name: str, path: Path, where: Where) -> bool:
    """Whether the file of a release holds a raster of thickness."""
    try:
        return holds_raster(path)
    except UserError as error:
        raise where.error(("body", name, "file"), f"body.{name}.file: {error}") from None


def _read(name: str, path: Path, where: Where, crs: str | None) -> Features:
    """What the file of a release holds, which must be polygons in the system of the terrain."""
    keys, place = ("body", name, "file"), f"body.{name}.file"
    try:
        features = read_features(path)
    except UserError as error:
        raise where.error(keys, f"{place}: {error}") from None
    if same_crs(features.crs, crs) is False:
        raise where.error(
            keys,
            f"{place}: {path} and the terrain have different coordinate reference systems; convert "
            "it with ogr2ogr -t_srs",
        )
    if not features.polygons:
        raise where.error(keys, f"{place}: {path} has no polygon")
    return features


def _from_file(
    name: str, release: Release, path: Path, where: Where, features: Features
) -> tuple[Any, Any]:
    """Polygons as lists of rings, and the thickness given or of each."""
    keys, place = ("body", name, "file"), f"body.{name}.file"
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
        is_number = isinstance(number, int | float) and not isinstance(number, bool)
        if not is_number or not 0 < number <= THICKEST:
            raise where.error(
                keys,
                f"{place}: a polygon of {path} has {FIELD} = {number!r}, not a length in m above "
                f"0 and up to {THICKEST:g}; give body.{name}.thickness",
            )
        thickness.append(float(number))
    return polygons, thickness
