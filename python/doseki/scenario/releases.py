"""Releases completed: polygons and thickness read from files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UserError
from ..geodata.crs import not_compared_text, why_not_compared
from ..geodata.features import Features, Polygon, read_on_map
from ..geodata.inside import crossing_of, is_line
from ..geodata.raster import holds_raster
from ..util.finding import Finding, place_text
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


@dataclass(frozen=True)
class NoArea(Finding):
    """An outline or a hole whose corners lie on a line, or an outline of which holes take all."""

    what: str
    at: tuple[float, float]  # m

    def __str__(self) -> str:
        return f"{self.place}: {self.what} at [{place_text(self.at)}] m has no area: it is left out"


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
        areas, thickness = features.polygons, _thickness_in(name, release, path, where, features)
    else:
        areas, thickness = _given_areas(release), release.thickness
    each = _one_each(name, thickness, len(areas), where)
    _check_areas(name, areas, where)
    doubts += _without_area(name, release, areas, where)
    kept = [pair for pair in zip(areas, each, strict=True) if pair[0].has_area]
    found["polygons"] = [_rings_with_area(area) for area, _ in kept]
    found["thickness"] = [thick for _, thick in kept]
    return release.model_copy(update=found), doubts


def _one_each(name: str, thickness: Any, count: int, where: Where) -> list[Any]:
    """A thickness for each of so many polygons."""
    if not isinstance(thickness, list):
        return [thickness] * count
    if len(thickness) != count:
        raise where.error(
            ("body", name, "thickness"),
            f"body.{name}.thickness has {_counted(len(thickness), 'number')} for "
            f"{_counted(count, 'polygon')}",
        )
    return thickness


def _given_areas(release: Release) -> tuple[Polygon, ...]:
    """Those that stand in the scenario."""
    given = [[release.polygon]] if release.polygon is not None else release.polygons or []
    return tuple(
        Polygon(outer, tuple(holes), source=f"area {k}")
        for k, rings in enumerate(given, 1)
        for outer, *holes in [[np.array(ring, float) for ring in rings]]
    )


def _rings_with_area(area: Polygon) -> list[Any]:
    """The rings of an area, without holes that have none."""
    holes = [hole for hole in area.holes if Polygon(hole).has_area]
    return [ring.tolist() for ring in (area.outer, *holes)]


def _without_area(
    name: str, release: Release, areas: Sequence[Polygon], where: Where
) -> Iterator[NoArea]:
    """What has no area and is left out; raises UserError where nothing else is there."""
    key = next(key for key in ("file", "polygon", "polygons") if getattr(release, key) is not None)
    place = f"body.{name}.{key}"
    if not any(area.has_area for area in areas):
        raise where.error(
            ("body", name, key),
            f"{place}: has no area at [{place_text(_middle(areas[0].outer))}] m, where its corners "
            "lie on a line or its holes take all of it: give corners around the area that is "
            "released",
        )
    for area in areas:
        if not area.has_area:
            yield NoArea(place, _part_of(area), _middle(area.outer))
            continue
        for k, hole in enumerate(area.holes, 1):
            if not Polygon(hole).has_area:
                yield NoArea(place, f"hole {k} of {area.source}", _middle(hole))


def _part_of(area: Polygon) -> str:
    """What messages call one of the areas."""
    return area.source if area.source.startswith("area ") else f"an area of {area.source}"


def _middle(ring: np.ndarray) -> tuple[float, float]:
    """The middle of its extent, m."""
    x, y = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
    return float(x), float(y)


def _counted(count: int, thing: str) -> str:
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _check_areas(name: str, areas: Sequence[Polygon], where: Where) -> None:
    """Refuse rings that cross themselves, and areas that lie in each other."""
    keys = ("body", name)
    for k, area in enumerate(areas, 1):
        if wrong := _wrong_ring(area, f"area {k}"):
            raise where.error(keys, f"body.{name}: {wrong}")
    numbered = [(k, area) for k, area in enumerate(areas, 1) if area.has_area]
    for (j, one), (k, other) in combinations(numbered, 2):
        shared = one.shared_with(other)
        if shared > OVERLAP * min(one.area, other.area):
            raise where.error(
                keys,
                f"body.{name}: areas {j} and {k} share {shared:.3g} m2, where "
                "particles of both would be: cut one of them, or make one area of both",
            )


def _wrong_ring(area: Polygon, name: str) -> str | None:
    """What is wrong with the outline of an area or with one of its holes."""
    for k, ring in enumerate(area.rings):
        at = None if is_line(ring) else crossing_of(ring)
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
        features = read_on_map(path, crs)
    except UserError as error:
        raise where.error(keys, f"{place}: {error}") from None
    if not features.polygons:
        raise where.error(keys, f"{place}: {path} has no polygon")
    return features


def _thickness_in(name: str, release: Release, path: Path, where: Where, features: Features) -> Any:
    """The thickness given, or that of each polygon of a file; None of one without area."""
    keys, place = ("body", name, "file"), f"body.{name}.file"
    if release.thickness is not None:
        return release.thickness
    thickness: list[float | None] = []
    for polygon in features.polygons:
        if not polygon.has_area:  # it is left out, whatever is said of it
            thickness.append(None)
            continue
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
    return thickness
