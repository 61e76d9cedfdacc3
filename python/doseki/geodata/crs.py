"""Coordinate reference systems, as far as a program that computes in metres must know them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from importlib.util import find_spec

from .errors import GeodataError

GEOGRAPHIC = ("GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "GEOGRAPHICCRS")
GEOCENTRIC = re.compile(
    r"GEOCCS\[|GEOD(?:ETIC)?CRS\[.*\bCS\[\s*Cartesian", re.IGNORECASE | re.DOTALL
)
PROJECTED = (
    "PROJCS", "PROJCRS", "PROJECTEDCRS", "COMPD_CS", "COMPOUNDCRS", "BOUNDCRS",
    "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS",
)  # fmt: skip
FEET = re.compile(r'UNIT\[\s*"([^"]*(?:foot|feet|ft|yard|link|chain)[^"]*)"', re.IGNORECASE)
LENGTH_UNIT = re.compile(
    r'\b(?:LENGTH)?UNIT\[\s*"((?!deg|grad)[^"]*)"\s*,\s*(\d+\.?\d*(?:e[-+]?\d+)?)', re.IGNORECASE
)
LAST_CODE = re.compile(r'(?:^EPSG:|(?:AUTHORITY|ID)\[\s*"EPSG",\s*"?)(\d+)"?(?:\s*\]){0,2}\s*$')
NAMED_CODE = re.compile(r"(?:^|[:/])EPSG(?:[:/][^:/]*)?[:/](\d+)", re.IGNORECASE)
# Numbers with EPSG that are degrees, geocentric or feet: what can be known without its tables.
NOT_METRES = (
    (2222, 2289), (2867, 2930), (3417, 3438), (3441, 3446), (3451, 3459), (3819, 3824),
    (4000, 4025), (4027, 4036), (4039, 4047), (4120, 4389), (4490, 4490), (4555, 4558),
    (4600, 4646), (4657, 4765), (4801, 4811), (4813, 4821), (4882, 5013), (6317, 6325),
    (6666, 6668), (7842, 7844),
)  # fmt: skip
COMPOUND = ("COMPD_CS", "COMPOUNDCRS")
MAP_PART = re.compile(r"(?:PROJC(?:S|RS)|GEO[A-Z]*C(?:S|RS)|LOCAL_CS|ENGCRS)\[")
MIN_CONFIDENCE = 70  # per cent; names of ESRI's WKT differ from those of EPSG
IN_DEGREES = re.compile(r"(?:^|[:/])CRS(?:84h?|83|27)$", re.IGNORECASE)
# Of the lines that ArcInfo wrote before there was WKT.
OLD_DEGREES = re.compile(r"^\s*(?:Projection\s+GEO|Units\s+D)", re.IGNORECASE | re.MULTILINE)
CONVERT = (
    "convert it with gdalwarp -t_srs EPSG:CODE IN OUT (vectors: ogr2ogr -t_srs EPSG:CODE OUT IN), "
    "such as 32633 for UTM zone 33 N"
)

BESIDE = 100.0  # m on a map, over which its scale is taken
EQUATOR, FLATTENED = 6_378_137.0, 0.00669438  # radius, m, and squared eccentricity of the Earth


def check_map_coordinates(path: object, crs: str) -> None:
    """Raise GeodataError where coordinates of this system are not metres on a map.

    `crs` is a WKT, or the name of an authority such as "EPSG:32633"; empty says nothing.
    """
    if not crs:
        return
    of_map = _horizontal(crs)
    keyword = re.match(r"[A-Za-z_]+", of_map)
    word = keyword[0].upper() if keyword and "[" in of_map else ""
    if GEOCENTRIC.match(of_map):
        raise GeodataError(f"{path}: coordinates are geocentric, not those of a map; {CONVERT}")
    if word in GEOGRAPHIC or IN_DEGREES.search(crs):
        raise GeodataError(f"{path}: coordinates are degrees, and metres are needed; {CONVERT}")
    if word in PROJECTED:
        _check_units(path, crs)
    elif OLD_DEGREES.search(crs):
        raise GeodataError(
            f"{path}: its lines say that coordinates are degrees, and metres are needed; {CONVERT}"
        )
    elif "[" in crs or ":" not in crs:
        raise GeodataError(
            f'{path}: "{crs[:40]}" is no coordinate reference system of a map in WKT; write one '
            "with gdalsrsinfo -o wkt_esri EPSG:CODE"
        )
    else:
        _check_named(path, crs)


def _check_units(path: object, wkt: str) -> None:
    of_map = _horizontal(wkt)
    if unit := FEET.search(of_map):
        raise GeodataError(not_metres(path, unit[1]))
    if unit := FEET.search(wkt):
        raise GeodataError(heights_not_metres(path, unit[1]))
    units = LENGTH_UNIT.findall(of_map)
    if units and float(units[-1][1]) != 1.0:
        raise GeodataError(not_metres(path, units[-1][0]))


def _check_named(path: object, name: str) -> None:
    """The same for a system of which only the name is known."""
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        code = _code_in(name)
        if code is not None and any(low <= code <= high for low, high in NOT_METRES):
            raise GeodataError(
                f"{path}: coordinates of EPSG:{code} are degrees, feet or geocentric, and metres "
                f"on a map are needed; {CONVERT}"
            ) from None
        return
    try:
        with Env():  # else what PROJ has to say goes to the terminal
            wkt = CRS.from_user_input(name).to_wkt()
    except CRSError:
        raise GeodataError(
            f'{path}: no coordinate reference system is called "{name[:40]}"'
        ) from None
    check_map_coordinates(path, wkt)


def _code_in(crs: str) -> int | None:
    """The number with EPSG that stands in a WKT or a name, of the map alone."""
    found = LAST_CODE.search(_horizontal(crs)) if "[" in crs else NAMED_CODE.search(crs)
    return None if found is None else int(found[1])


def epsg_code(crs: str | None) -> int | None:
    """The number of a system (WKT, or a name such as "EPSG:32633") with EPSG, of the map alone.

    None where it has none, or where only rasterio could find it and is not installed.
    """
    if not crs:
        return None
    if (found := _code_in(crs)) is not None:
        return found
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        return None
    try:
        with Env():
            of_map = CRS.from_user_input(_horizontal(crs))
            code = of_map.to_epsg(confidence_threshold=MIN_CONFIDENCE)
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


def not_metres(path: object, unit: str) -> str:
    """What is said of a map in feet."""
    return f'{path}: the unit is "{unit}", and metres are needed; {CONVERT}'


def heights_not_metres(path: object, unit: str) -> str:
    """What is said of heights in feet, which no change of the map's system converts."""
    return (
        f'{path}: heights are in "{unit}", and metres are needed; multiply them by its length, as '
        'in gdal_calc.py -A IN --calc="A*0.3048" --outfile OUT, and say so with '
        "gdal_edit.py -a_srs EPSG:CODE -units m OUT"
    )


def same_crs(one: str | None, other: str | None) -> bool | None:
    """Whether two systems (WKT, or names such as "EPSG:32633") are the same on the map.

    None where that cannot be told: one is not known, or has no number with EPSG in it and rasterio
    is not installed.
    """
    if one is None or other is None:
        return None
    if _horizontal(one) == _horizontal(other):
        return True
    try:
        from rasterio import Env
        from rasterio.crs import CRS
        from rasterio.errors import CRSError
    except ImportError:
        codes = _code_in(one), _code_in(other)
        return None if None in codes else codes[0] == codes[1]
    try:
        with Env():
            found = (CRS.from_user_input(each).to_wkt() for each in (one, other))
            first, second = (CRS.from_wkt(_horizontal(wkt)) for wkt in found)
            codes = first.to_epsg(MIN_CONFIDENCE), second.to_epsg(MIN_CONFIDENCE)
    except CRSError:
        return None
    return bool(first == second) or (codes[0] is not None and codes[0] == codes[1])


def check_same_crs(path: object, own: str | None, of_terrain: str | None) -> None:
    """Raise GeodataError where a file in the system `own` is known not to lie on the terrain's map.

    The sentence names both systems and the command that converts a file of polygons, lines or
    cells.
    """
    if same_crs(own, of_terrain) is not False:
        return
    code = epsg_code(of_terrain)
    target = "CODE (that of the terrain)" if code is None else str(code)
    raise GeodataError(
        f"{path}: is in {_name(own)}, another coordinate reference system than that of the terrain,"
        f" {_name(of_terrain)}; convert it with ogr2ogr -t_srs EPSG:{target} OUT IN, a raster with "
        f"gdalwarp -t_srs EPSG:{target} IN OUT"
    )


def _name(crs: str | None) -> str:
    """The number with EPSG, or the name that a WKT begins with."""
    code = epsg_code(crs)
    if code is not None:
        return f"EPSG:{code}"
    quoted = re.search(r'"([^"]*)"', crs or "")
    return f'"{quoted[1] if quoted else (crs or "")[:40]}"'


def needs_rasterio(one: str | None, other: str | None) -> bool:
    """Whether only rasterio, which is not installed, could say if `one` is the system of `other`.

    Where the other one is not known: if `one`, which is but a name, is in metres.
    """
    if one is None or (other is None and "[" in one):
        return False
    return same_crs(one, other) is None and find_spec("rasterio") is None


def why_not_compared(one: str | None, other: str | None) -> str | None:
    """Why it is not known whether `one`, the system of a file, is `other`, that of the terrain.

    None where it is known, or where `one` is None: then coordinates are those of the terrain.
    """
    if one is None or same_crs(one, other) is not None:
        return None
    if needs_rasterio(one, other):
        return "which needs rasterio: pip install 'doseki[terrain]'"
    if other is None:
        return (
            "as that of the terrain is not known: make sure that they are the same, and say so in "
            "a .prj file beside its map, or with gdal_edit.py -a_srs EPSG:CODE"
        )
    return "as one of the two is not known to rasterio: make sure that they are the same"


def not_compared_text(file: object, why: str) -> str:
    """What is said of a file whose system was not compared."""
    return (
        f"whether {file} has the coordinate reference system of the terrain was not compared, {why}"
    )


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
