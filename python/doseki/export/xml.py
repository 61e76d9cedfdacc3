"""What the XML formats of VTK have in common: arrays behind the XML as raw bytes."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

VTK_TYPES = {"float64": "Float64", "int32": "Int32", "int64": "Int64", "uint8": "UInt8"}
BYTE_ORDER = {"little": "LittleEndian", "big": "BigEndian"}[sys.byteorder]

Strings = Mapping[str, Sequence[str]]  # of the file, by the name of their array


class Blocks:
    """Arrays to be appended to the XML: each is its length in bytes (UInt64), then its bytes."""

    def __init__(self) -> None:
        self._arrays: list[np.ndarray] = []
        self._offset = 0

    def add(self, name: str, array: np.ndarray, unit: str = "") -> str:
        """Queue an array; returns the XML element that refers to it and says its unit."""
        element = (
            f'<DataArray type="{VTK_TYPES[array.dtype.name]}" Name={quoteattr(name)} '
            f'NumberOfComponents="{array.shape[1] if array.ndim > 1 else 1}" '
            f'format="appended" offset="{self._offset}"'
        )
        self._arrays.append(np.ascontiguousarray(array))
        self._offset += np.uint64(0).nbytes + array.nbytes
        if not unit:
            return element + "/>"
        return (
            f'{element}>\n<InformationKey name="UNITS_LABEL" location="vtkDataArray">'
            f"{escape(unit)}</InformationKey>\n</DataArray>"
        )

    def write(self, path: Path, kind: str, body: str) -> None:
        """Write a file of a kind of VTK's data: its XML `body`, then what was queued."""
        head = (
            f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" '
            f'byte_order="{BYTE_ORDER}" header_type="UInt64">\n<{kind}>\n{body}\n</{kind}>\n'
            '<AppendedData encoding="raw">\n_'
        )
        with path.open("wb") as file:
            file.write(head.encode())
            for array in self._arrays:
                file.write(np.uint64(array.nbytes).tobytes())
                file.write(array.tobytes())
            file.write(b"\n</AppendedData>\n</VTKFile>\n")


def field_data(time: float | None, strings: Strings) -> str:
    """The element of what belongs to the whole file: its time, s, and arrays of strings."""
    rows = []
    if time is not None:
        rows.append(
            f'<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">'
            f"{time!r}</DataArray>"
        )
    for name, entries in strings.items():
        rows.append(string_array(name, entries, "NumberOfTuples"))
    return f"<FieldData>{''.join(rows)}</FieldData>"


def string_array(name: str, entries: Sequence[str], count: str = "") -> str:
    """An array of strings: their bytes as numbers, a zero after each; `count` names its length."""
    length = f'{count}="{len(entries)}" ' if count else ""
    codes = " ".join(str(code) for entry in entries for code in (*entry.encode(), 0))
    return (
        f'<DataArray type="String" Name={quoteattr(name)} {length}format="ascii">{codes}'
        "</DataArray>"
    )


def units_of(units: Mapping[str, str]) -> list[str]:
    """Units of arrays as strings "Velocity [m/s]", for whoever does not see those of arrays."""
    return [f"{name} [{unit}]" for name, unit in units.items() if unit]
