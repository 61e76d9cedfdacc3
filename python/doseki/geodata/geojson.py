"""GeoJSON (RFC 7946), with the `crs` member of its first edition, which GDAL and QGIS write."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..util.foreign import read_text
from .crs import check_map_coordinates
from .errors import GeodataError
from .outlines import Features, Line, Polygon
from .shapes import line_of, polygon_of

MAX_BYTES = 500_000_000
URN = re.compile(r"urn:ogc:def:crs:([^:]+):[^:]*:([^:]+)")  # such as EPSG::32633
DRAWN = ("Polygon", "MultiPolygon", "LineString", "MultiLineString")


def read_geojson(path: Path) -> Features:
    """Polygons and lines of a file.

    Raises:
        GeodataError: it is no GeoJSON, holds something else, or says that it is in degrees.
        UserError: it cannot be read.

    """
    content = _parsed(path, read_text(path, MAX_BYTES).removeprefix("\ufeff").rstrip())
    crs = _crs(path, content)
    found = [shape for feature in _features(path, content) for shape in _shapes(path, *feature)]
    polygons = tuple(shape for shape in found if isinstance(shape, Polygon))
    lines = tuple(shape for shape in found if isinstance(shape, Line))
    return Features(polygons, lines, crs)


def _parsed(path: Path, text: str) -> Any:
    """What a text holds that is JSON; raises GeodataError for one that is none."""
    if not text:
        raise GeodataError(f"{path}: no GeoJSON: the file is empty")
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        if error.pos >= len(text) or error.msg.startswith("Unterminated"):
            raise GeodataError(
                f"{path}: no GeoJSON: it stops in the middle, as a file that was cut off when it "
                "was copied or downloaded; bring a whole one"
            ) from None
        raise GeodataError(
            f"{path}, line {error.lineno}: no GeoJSON: what stands at column {error.colno} cannot "
            "be there"
        ) from None
    except RecursionError:
        raise GeodataError(f"{path}: no GeoJSON: lists within lists, too many deep") from None
    except ValueError:  # of numbers of thousands of digits
        raise GeodataError(f"{path}: no GeoJSON: a number has too many digits") from None


def _crs(path: Path, content: Any) -> str | None:
    """The name of the system of coordinates; None where the file has none."""
    member = content.get("crs") if isinstance(content, dict) else None
    if member is None:
        return None
    try:
        name = str(member["properties"]["name"])
    except (KeyError, TypeError):
        raise GeodataError(f'{path}: its "crs" has no name') from None
    check_map_coordinates(path, name)
    urn = URN.fullmatch(name)
    return f"{urn[1]}:{urn[2]}" if urn else name


Feature = tuple[int, Mapping[str, Any], Mapping[str, Any]]  # number, geometry, attributes


def _features(path: Path, content: Any) -> Iterator[Feature]:
    """The geometry and the attributes of each feature."""
    kind = content.get("type") if isinstance(content, dict) else None
    if kind == "FeatureCollection":
        features = content.get("features")
        if not isinstance(features, list):
            raise GeodataError(f'{path}: its "features" must be a list')
    elif kind == "Feature":
        features = [content]
    else:
        features = [{"geometry": content, "properties": {}}]
    for number, feature in enumerate(features, 1):
        geometry = feature.get("geometry") if isinstance(feature, dict) else None
        if not isinstance(geometry, dict):
            raise GeodataError(
                f"{path}, feature {number}: no geometry; draw its area or line, or take the "
                "feature out"
            )
        attributes = feature.get("properties") or {}
        if not isinstance(attributes, dict):
            raise GeodataError(f'{path}, feature {number}: its "properties" must be an object')
        yield number, geometry, attributes


def _shapes(
    path: Path, number: int, geometry: Mapping[str, Any], attributes: Mapping[str, Any]
) -> Iterator[Polygon | Line]:
    """The polygons or lines of one feature."""
    where, kind = f"{path}, feature {number}", geometry.get("type")
    if kind not in DRAWN:
        raise GeodataError(f"{where}: {str(kind)[:40]} is not read; {', '.join(DRAWN)} are")
    coordinates = geometry.get("coordinates")
    parts = coordinates if kind.startswith("Multi") else [coordinates]
    if not isinstance(parts, list):
        raise GeodataError(f"{where}: coordinates must be a list")
    for part in parts:
        if not isinstance(part, list):
            raise GeodataError(f"{where}: coordinates must be a list")
        if kind.endswith("Polygon"):
            yield polygon_of(where, part, attributes)
        else:
            yield line_of(where, part, attributes)
