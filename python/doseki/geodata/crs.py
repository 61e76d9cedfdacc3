"""Coordinate reference systems, as far as a program that computes in metres must know them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from .errors import GeodataError

GEOGRAPHIC = ("GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "GEOGRAPHICCRS", "GEOCCS")
PROJECTED = (
    "PROJCS", "PROJCRS", "PROJECTEDCRS", "COMPD_CS", "COMPOUNDCRS", "BOUNDCRS",
    "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS",
)  # fmt: skip
FEET = re.compile(r'UNIT\[\s*"([^"]*(?:foot|feet|ft|yard|link|chain)[^"]*)"', re.IGNORECASE)
LAST_CODE = re.compile(r'(?:^EPSG:|(?:AUTHORITY|ID)\[\s*"EPSG",\s*"?)(\d+)"?(?:\s*\]){0,2}\s*$')
COMPOUND = ("COMPD_CS", "COMPOUNDCRS")
MAP_PART = re.compile(r"PROJC(?:S|RS)\[")
MIN_CONFIDENCE = 70  # per cent; names of ESRI's WKT differ from those of EPSG
IN_DEGREES = re.compile(r"(?:^|:)(?:CRS84h?|EPSG:[^:]*:?(?:4326|4258|4979))$", re.IGNORECASE)

BESIDE = 100.0  # m on a map, over which its scale is taken
EQUATOR, FLATTENED = 6_378_137.0, 0.00669438  # radius, m, and squared eccentricity of the Earth


def check_map_coordinates(path: object, crs: str) -> None:
    """Raise GeodataError where coordinates of this system are not metres on a map.

    `crs` is a WKT, or the name of an authority such as "EPSG:32633"; empty says nothing.
    """
    if not crs:
        return
    keyword = re.match(r"[A-Za-z_]+", crs)
    word = keyword[0].upper() if keyword and "[" in crs else ""
    if word in GEOGRAPHIC or IN_DEGREES.search(crs):
        raise GeodataError(in_degrees(path))
    if word in PROJECTED:
        if unit := FEET.search(crs):
            raise GeodataError(not_metres(path, unit[1]))
        return
    if ":" not in crs:
        raise GeodataError(
            f'{path}: "{crs[:40]}" is no coordinate reference system in WKT; write one with '
            f"gdalsrsinfo -o wkt_esri EPSG:CODE"
        )
    _check_named(path, crs)


def _check_named(path: object, name: str) -> None:
    """The same for a system of which only the name is known, where rasterio can look it up."""
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        return
    try:
        with Env():  # else what PROJ has to say goes to the terminal
            found = CRS.from_user_input(name)
    except CRSError:
        raise GeodataError(
            f'{path}: no coordinate reference system is called "{name[:40]}"'
        ) from None
    if found.is_geographic:
        raise GeodataError(in_degrees(path))
    if found.is_projected and found.linear_units_factor[1] != 1.0:
        raise GeodataError(not_metres(path, found.linear_units))


def epsg_code(crs: str | None) -> int | None:
    """The number of a system (WKT, or a name such as "EPSG:32633") with EPSG.

    None where it has none, or where only rasterio could find it and is not installed.
    """
    if not crs:
        return None
    if found := LAST_CODE.search(crs):
        return int(found[1])
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        return None
    try:
        with Env():
            code = CRS.from_user_input(crs).to_epsg(confidence_threshold=MIN_CONFIDENCE)
    except CRSError:
        return None
    return None if code is None else int(code)


@dataclass(frozen=True)
class MapScale:
    """How many metres of a map one on the ground has, at a latitude, degrees, and UTM's system."""

    factor: float
    latitude: float
    utm: int  # number with EPSG of the zone in which the place lies


def map_scale(crs: str | None, x: float, y: float) -> MapScale | None:
    """The scale of a system (WKT or name) at a place, m: along the axis where it is farther from 1.

    None where the system is not known, is not one of the Earth, or rasterio is not installed.
    """
    if crs is None:
        return None
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.warp import transform
    except ImportError:
        return None
    places = [x, x + BESIDE, x], [y, y, y + BESIDE]
    try:
        with Env():
            of_map = CRS.from_wkt(_horizontal(CRS.from_user_input(crs).to_wkt()))
            if not of_map.is_projected:
                return None
            found = transform(of_map, CRS.from_epsg(4326), *places)
    except Exception:  # GDAL's own, of places where there is no such map, have no public class
        return None
    longitude, latitude = found[:2]
    if not all(map(math.isfinite, (*longitude, *latitude))):
        return None
    start = longitude[0], latitude[0]
    ends = zip(longitude[1:], latitude[1:], strict=True)
    lengths = [_length(start, end) for end in ends]
    if min(lengths) <= 0:
        return None
    factors = [BESIDE / length for length in lengths]
    factor = max(factors, key=lambda each: abs(math.log(each)))
    zone = int((start[0] + 180) // 6) % 60 + 1
    return MapScale(factor, start[1], (32600 if start[1] >= 0 else 32700) + zone)


def _length(start: tuple[float, float], end: tuple[float, float]) -> float:
    """How far two near places (longitude, latitude), degrees, are apart on the ellipsoid, m."""
    latitude = math.radians(start[1])
    flat = 1 - FLATTENED * math.sin(latitude) ** 2
    east = math.radians((end[0] - start[0] + 180) % 360 - 180)
    north = math.radians(end[1] - start[1])
    across = EQUATOR / math.sqrt(flat) * math.cos(latitude)
    return math.hypot(across * east, EQUATOR * (1 - FLATTENED) / flat**1.5 * north)


def in_degrees(path: object) -> str:
    """What is said of coordinates that are longitudes and latitudes."""
    return (
        f"{path}: coordinates are degrees, and metres are needed; convert it with "
        f"gdalwarp -t_srs EPSG:CODE IN OUT (vectors: ogr2ogr -t_srs EPSG:CODE OUT IN), such as "
        f"32633 for UTM zone 33 N"
    )


def not_metres(path: object, unit: str) -> str:
    """What is said of a map in feet."""
    return f'{path}: the unit is "{unit}", and metres are needed; convert it with gdalwarp -t_srs'


def same_crs(one: str | None, other: str | None) -> bool | None:
    """Whether two systems (WKT, or names such as "EPSG:32633") are the same on the map.

    None where that cannot be told: one is not known, or rasterio is not installed.
    """
    if one is None or other is None:
        return None
    if one == other:
        return True
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        return None
    try:
        with Env():
            found = (CRS.from_user_input(each).to_wkt() for each in (one, other))
            first, second = (CRS.from_wkt(_horizontal(wkt)) for wkt in found)
            codes = first.to_epsg(MIN_CONFIDENCE), second.to_epsg(MIN_CONFIDENCE)
    except CRSError:
        return None
    return bool(first == second) or (codes[0] is not None and codes[0] == codes[1])


def _horizontal(wkt: str) -> str:
    """A system without the heights that a compound one adds to it."""
    start = MAP_PART.search(wkt)
    if not wkt.startswith(COMPOUND) or start is None:
        return wkt
    depth = 0
    for k in range(start.start(), len(wkt)):
        depth += (wkt[k] == "[") - (wkt[k] == "]")
        if wkt[k] == "]" and depth == 0:
            return wkt[start.start() : k + 1]
    return wkt
