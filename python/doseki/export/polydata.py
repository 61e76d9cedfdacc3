"""VTP: points, lines and polygons with fields, in double precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .xml import Blocks, Strings, field_data, string_array, units_of

CELLS = ("Verts", "Lines", "Strips", "Polys")  # as VTK orders them


@dataclass
class PolyData:
    """What a .vtp holds: `points` (n, dim) in m, fields of points and of cells by name, units.

    Cells are arrays of indices of points, in the order `verts`, `lines`, `polys`; fields of cells
    have that order. `names` are strings of the cells, `strings` those of the whole file.
    """

    points: np.ndarray
    verts: Sequence[np.ndarray] | np.ndarray = ()
    lines: Sequence[np.ndarray] | np.ndarray = ()
    polys: Sequence[np.ndarray] | np.ndarray = ()
    fields: dict[str, np.ndarray] = field(default_factory=dict)
    cell_fields: dict[str, np.ndarray] = field(default_factory=dict)
    names: Strings = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    strings: Strings = field(default_factory=dict)
    time: float | None = None

    def write(self, path: Path) -> None:
        """Write the file; raises OSError."""
        blocks = Blocks()
        cells = dict(zip(CELLS, (self.verts, self.lines, (), self.polys), strict=True))
        counts = " ".join(f'NumberOf{kind}="{len(each)}"' for kind, each in cells.items())
        units = {"Points": "m", **self.units}
        parts = [
            field_data(self.time, {**self.strings, "Units": units_of(units)}),
            f'<Piece NumberOfPoints="{len(self.points)}" {counts}>',
            f"<Points>{blocks.add('Points', in_space(self.points), 'm')}</Points>",
        ]
        for kind, each in cells.items():
            parts.append(f"<{kind}>{_cells(blocks, each)}</{kind}>")
        parts.append(f"<PointData>{self._arrays(blocks, self.fields)}</PointData>")
        named = "".join(string_array(name, entries) for name, entries in self.names.items())
        parts.append(f"<CellData>{self._arrays(blocks, self.cell_fields)}{named}</CellData>")
        blocks.write(path, "PolyData", "\n".join([*parts, "</Piece>"]))

    def _arrays(self, blocks: Blocks, fields: dict[str, np.ndarray]) -> str:
        return "".join(blocks.add(k, v, self.units.get(k, "")) for k, v in fields.items())


def _cells(blocks: Blocks, cells: Sequence[np.ndarray] | np.ndarray) -> str:
    if isinstance(cells, np.ndarray):
        sizes, flat = np.full(len(cells), cells.shape[1]), cells.ravel()
    else:
        sizes = np.array([len(cell) for cell in cells], np.int64)
        flat = np.concatenate([np.zeros(0, np.int64), *cells])
    return blocks.add("connectivity", flat.astype(np.int64)) + blocks.add(
        "offsets", np.cumsum(sizes, dtype=np.int64)
    )


def in_space(vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) of float64; the third component of those of a 2-D run is zero."""
    padded = np.pad(np.asarray(vectors, float), ((0, 0), (0, 3 - vectors.shape[1])))
    return np.ascontiguousarray(padded)
