"""The ground of a run on a terrain, as it was used: a raster in 3-D, a profile in 2-D."""

from __future__ import annotations

import csv
from dataclasses import dataclass

import numpy as np

from ..errors import UserError
from ..geodata.raster import Raster, read_raster, write_raster
from ..util.files import write_whole_text
from ..util.foreign import read_text, readable
from .folder import RunFolder

HEADER = ["x", "z"]


@dataclass(frozen=True, eq=False)
class Profile:
    """Heights of the ground of a 2-D run: places (N,) and heights (N,), m."""

    x: np.ndarray
    z: np.ndarray


def write_ground(folder: RunFolder, ground: Raster | Profile) -> None:
    """Put terrain.tif, terrain.asc or, of a profile, terrain.csv into the folder of a run."""
    for file in folder.ground_files():
        file.unlink()
    if isinstance(ground, Raster):
        write_raster(folder.path / f"terrain{ground.suffix}", ground)
        return
    rows = [HEADER, *zip(ground.x.tolist(), ground.z.tolist(), strict=True)]
    text = "".join(f"{x},{z}\n" for x, z in rows)
    write_whole_text(folder.path / "terrain.csv", text)


def read_ground(folder: RunFolder) -> Raster | Profile | None:
    """What write_ground wrote; None for a run without a terrain.  Raises UserError."""
    files = [file for file in folder.ground_files() if file.suffix != ".prj"]
    if not files:
        return None
    if files[0].suffix != ".csv":
        return read_raster(files[0])
    path = files[0]
    text = read_text(path)
    with readable(path):
        header, *rows = csv.reader(text.splitlines())
    if header != HEADER or not rows:
        raise UserError(f"{path}: is not the profile of a run: columns x, z are expected")
    with readable(path):
        table = np.array([[float(number) for number in row] for row in rows])
    return Profile(table[:, 0], table[:, 1])
