"""ESRI ASCII grids: a header of names and numbers, then rows from north to south.

The format is that of ArcInfo's GRIDASCII; GDAL calls it AAIGrid. What coordinates mean says a .prj
file of the same name beside it.
"""

from __future__ import annotations

import math
import re
import warnings
from pathlib import Path

import numpy as np

from ..util.files import write_whole_text
from ..util.foreign import read_text
from ..util.spelling import suggestion
from .crs import check_map_coordinates
from .errors import GeodataError
from .grid import Raster, means_no_data

KEYS = (
    "ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter",
    "cellsize", "dx", "dy", "nodata_value",
)  # fmt: skip
HEADER_LINE = re.compile(r"[ \t\r\n]*([A-Za-z_]+)[ \t]+(\S+)[ \t]*\r?\n?")
NOT_VALUES = ("nan", "inf", "infinity", "null")
SQUARE = 1e-6  # relative difference of dx and dy
MAX_PRJ = 100_000  # bytes


def is_ascii_grid(start: bytes) -> bool:
    """Whether a file that begins like this has the header of such a grid."""
    word = start.lstrip(b"\xef\xbb\xbf \t\r\n")[:20].split(maxsplit=1)
    return bool(word) and word[0].decode("ascii", "replace").lower() in KEYS


def read_ascii_grid(path: Path) -> Raster:
    """The grid of a file.

    Raises:
        GeodataError: it is damaged, or its cells are not square.
        UserError: it cannot be read.

    """
    text = read_text(path).removeprefix("\ufeff")
    header, start = _header(path, text)
    rows, cols = _count(path, header, "nrows"), _count(path, header, "ncols")
    cell = _cell(path, header)
    values = _values(path, text, start)
    if len(values) != rows * cols:
        raise GeodataError(
            f"{path}: {len(values)} values where nrows = {rows} and ncols = {cols} make "
            f"{rows * cols}; is it cut off?"
        )
    _check_lines(path, text[start:], rows, cols)
    nodata = _number(path, header, "nodata_value") if "nodata_value" in header else None
    if nodata is not None:
        values[means_no_data(values, nodata)] = np.nan
    if np.isinf(values).any():
        raise GeodataError(f"{path}: holds infinite values")
    return Raster(
        values.reshape(rows, cols),
        _edge(path, header, "x", cell),
        _edge(path, header, "y", cell),
        cell,
        _crs_beside(path),
        "AAIGrid",
        nodata,
    )


def _header(path: Path, text: str) -> tuple[dict[str, str], int]:
    """Values of the keys in small letters, and where in the text they end."""
    found: dict[str, str] = {}
    position = 0
    while (match := HEADER_LINE.match(text, position)) and _is_key(match[1]):
        key = match[1].lower()
        if key not in KEYS:
            raise GeodataError(f'{path}: unknown line "{match[1]}"{suggestion(key, KEYS)}')
        if key in found:
            raise GeodataError(f"{path}: {key} is given twice")
        found[key] = match[2]
        position = match.end()
    return found, position


def _is_key(word: str) -> bool:
    return word.lower() not in NOT_VALUES


def _number(path: Path, header: dict[str, str], key: str) -> float:
    try:
        return float(header[key])
    except KeyError:
        raise GeodataError(f"{path}: {key} is missing") from None
    except ValueError:
        raise GeodataError(f'{path}: {key} must be a number, not "{header[key]}"') from None


def _finite(path: Path, header: dict[str, str], key: str) -> float:
    value = _number(path, header, key)
    if not math.isfinite(value):
        raise GeodataError(f"{path}: {key} must be finite, not {header[key]}")
    return value


def _count(path: Path, header: dict[str, str], key: str) -> int:
    value = _finite(path, header, key)
    if value < 1 or value != int(value):
        raise GeodataError(f"{path}: {key} must be a whole number above 0, not {header[key]}")
    return int(value)


def _cell(path: Path, header: dict[str, str]) -> float:
    """The side of cells, m; dx and dy may give it instead of cellsize, if they are equal."""
    if "dx" in header or "dy" in header:
        if "cellsize" in header:
            raise GeodataError(f"{path}: cellsize and dx or dy exclude each other")
        dx, dy = _finite(path, header, "dx"), _finite(path, header, "dy")
        if abs(dx - dy) > SQUARE * abs(dx):
            raise GeodataError(not_square(path, dx, dy))
    else:
        dx = _finite(path, header, "cellsize")
    if dx <= 0:
        raise GeodataError(f"{path}: cells of {dx:g} m; they must be larger than 0")
    return dx


def not_square(path: Path, dx: float, dy: float) -> str:
    """What is said of cells that are no squares."""
    return (
        f"{path}: cells of {dx:.10g} m by {dy:.10g} m are not square; make them so with "
        f"gdalwarp -tr {dx:.6g} {dx:.6g} -r bilinear IN OUT"
    )


def _edge(path: Path, header: dict[str, str], axis: str, cell: float) -> float:
    """The outer edge in the west (x) or south (y), m."""
    corner, centre = f"{axis}llcorner", f"{axis}llcenter"
    if corner in header and centre in header:
        raise GeodataError(f"{path}: {corner} and {centre} exclude each other")
    if centre in header:
        return _finite(path, header, centre) - cell / 2
    return _finite(path, header, corner)


def _values(path: Path, text: str, start: int) -> np.ndarray:
    """The numbers that follow the header."""
    body = text[start:]
    if not body.strip():
        return np.empty(0)
    with warnings.catch_warnings():
        # Of text that is no number numpy reads what comes before, and warns.
        warnings.simplefilter("error")
        try:
            return np.fromstring(body, sep=" ")
        except (DeprecationWarning, ValueError):
            raise GeodataError(_first_word(path, text, start)) from None


def _check_lines(path: Path, body: str, rows: int, cols: int) -> None:
    """Where each row has a line, refuse one that is too long, by which the next would move.

    With other numbers of lines they may be wrapped anywhere.
    """
    counts = [count for line in body.splitlines() if (count := len(line.split()))]
    if len(counts) != rows:
        return
    for row, count in enumerate(counts, 1):
        if count != cols:
            raise GeodataError(f"{path}: row {row} has {count} values where ncols = {cols}")


def _first_word(path: Path, text: str, start: int) -> str:
    """Which value is no number, and where."""
    first = text.count("\n", 0, start) + 1
    for line, content in enumerate(text[start:].splitlines(), first):
        for word in content.split():
            try:
                float(word)
            except ValueError:
                return f'{path}, line {line}: "{word[:40]}" is no number'
    return f"{path}: its values cannot be read as numbers"


def _crs_beside(path: Path) -> str | None:
    """The WKT of the .prj file of the same name."""
    for beside in (path.with_suffix(".prj"), path.with_suffix(".PRJ")):
        if beside.exists():
            wkt = read_text(beside, MAX_PRJ).strip()
            check_map_coordinates(beside, wkt)
            return wkt or None
    return None


def write_ascii_grid(path: Path, raster: Raster) -> None:
    """Write a grid so that the same numbers are read back, and its .prj beside it."""
    nodata = -9999.0 if raster.nodata is None else raster.nodata
    header = {
        "ncols": raster.shape[1],
        "nrows": raster.shape[0],
        "xllcorner": raster.west,
        "yllcorner": raster.south,
        "cellsize": raster.cell,
        "NODATA_value": nodata,
    }
    lines = [f"{key:<13} {_text(value)}" for key, value in header.items()]
    values = np.where(np.isnan(raster.values), nodata, raster.values)
    lines += [" ".join(map(_text, row)) for row in values.tolist()]
    write_whole_text(path, "\n".join(lines) + "\n")
    if raster.crs is not None:
        write_whole_text(path.with_suffix(".prj"), raster.crs + "\n")
    else:
        path.with_suffix(".prj").unlink(missing_ok=True)  # it would be that of another grid


def _text(value: float) -> str:
    """The shortest decimal number that is read back as the same."""
    if math.isfinite(value) and value == int(value) and abs(value) < 1e15:
        return str(int(value))
    return repr(float(value))
