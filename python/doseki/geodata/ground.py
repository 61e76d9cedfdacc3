"""The ground of a run, as it was used: a raster in 3-D, a profile in 2-D."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import UserError
from ..util.files import write_whole_text
from ..util.foreign import read_text, readable
from .raster import Raster, read_raster, write_raster

SUFFIXES = (".tif", ".asc", ".csv", ".prj")
HEADER = ["x", "z"]


@dataclass(frozen=True, eq=False)
class Profile:
    """Heights of the ground of a 2-D run: places (N,) and heights (N,), m."""

    x: np.ndarray
    z: np.ndarray


def ground_files(folder: Path) -> list[Path]:
    """The ground in the folder of a run, and what stands beside it."""
    files = (folder / f"terrain{suffix}" for suffix in SUFFIXES)
    return [file for file in files if file.exists()]


def write_ground(folder: Path, ground: Raster | Profile) -> None:
    """Put terrain.tif, terrain.asc or, of a profile, terrain.csv into the folder of a run."""
    for file in ground_files(folder):
        file.unlink()
    if isinstance(ground, Raster):
        # The number for no data in the file that it came from may be a height of this one.
        write_raster(folder / f"terrain{ground.suffix}", ground.with_free_nodata())
        return
    rows = [HEADER, *zip(ground.x.tolist(), ground.z.tolist(), strict=True)]
    write_whole_text(folder / "terrain.csv", "".join(f"{x},{z}\n" for x, z in rows))


def read_ground(folder: Path) -> Raster | Profile | None:
    """What write_ground wrote; None for a run without a terrain.  Raises UserError."""
    files = [file for file in ground_files(folder) if file.suffix != ".prj"]
    if not files:
        return None
    return _read_profile(files[0]) if files[0].suffix == ".csv" else read_raster(files[0])


def _read_profile(path: Path) -> Profile:
    text = read_text(path)
    with readable(path, kind="the profile of a run"):
        header, *rows = csv.reader(text.splitlines())
        table = np.array([[float(number) for number in row] for row in rows])
    if header != HEADER or table.ndim != 2 or table.shape[1] != 2 or not np.isfinite(table).all():
        raise UserError(f"{path}: is not the profile of a run: columns x, z are expected")
    return Profile(table[:, 0], table[:, 1])
