"""Export to VTU, the format that viewers older than ParaView 5.12 read."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from ..record.fields import FIELDS
from ..record.reader import Run, Snapshot
from ..util.files import write_whole, write_whole_text
from .folder import pvd, whole_folder
from .xml import Blocks, field_data, units_of

COLLECTION = "run.pvd"
VTK_VERTEX = 1


def export_vtu(run: Run, out: str | Path | None = None) -> Path:
    """Write one .vtu for each snapshot and a .pvd with their times; returns the .pvd.

    They go to the folder `out` (default: DIR/vtu), which must not exist or be empty, and no link,
    or UserError is raised. It is there once it is whole.
    """
    folder = Path(out) if out is not None else run.directory / "vtu"
    with whole_folder(folder) as unfinished:
        entries = []
        for snapshot in run:
            file = unfinished / f"{snapshot.path.stem}.vtu"
            write_whole(file, partial(_write_vtu, snapshot))
            entries.append((snapshot.time, file.name))
        write_whole_text(unfinished / COLLECTION, pvd(entries))
    return folder / COLLECTION


def _write_vtu(snapshot: Snapshot, path: Path) -> None:
    """One unstructured grid of vertices."""
    blocks = Blocks()
    n = len(snapshot.stored("id"))
    position, *others = FIELDS
    points = blocks.add(position.file_name, position.encode(snapshot.stored("position")), "m")
    cells = (
        blocks.add("connectivity", np.arange(n)),
        blocks.add("offsets", np.arange(1, n + 1)),
        blocks.add("types", np.full(n, VTK_VERTEX, np.uint8)),
    )
    units = {field.file_name: field.unit_in(snapshot.dim) for field in FIELDS}
    data = [
        blocks.add(f.file_name, f.encode(snapshot.stored(f.key)), units[f.file_name])
        for f in others
    ]
    names = {
        "MaterialNames": snapshot.material_names,
        "BodyNames": snapshot.body_names,
        "Units": units_of(units),
    }
    body = (
        f"{field_data(snapshot.time, names)}\n"
        f'<Piece NumberOfPoints="{n}" NumberOfCells="{n}">\n'
        f"<Points>{points}</Points>\n<Cells>{''.join(cells)}</Cells>\n"
        f"<PointData>{''.join(data)}</PointData>\n</Piece>"
    )
    blocks.write(path, "UnstructuredGrid", body)
