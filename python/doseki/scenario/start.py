"""Scenarios to begin with: commented files that run at once."""

from __future__ import annotations

import re
from pathlib import Path

from ..errors import UserError
from ..util.files import write_whole_text

STARTS = Path(__file__).resolve().parent / "starts"
MARK = re.compile(r"\s*#([23])$")  # a line that only one number of dimensions has


def write_start(path: Path, dim: int, dry: bool) -> None:
    """Write a scenario in `dim` dimensions, of water and a block or of dry grains, to `path`.

    Raises UserError where there is something already, for a name that does not end in .toml, and
    where the folder is missing.
    """
    if path.suffix != ".toml":
        raise UserError(f"{path}: a scenario is a file that ends in .toml")
    if path.exists() or path.is_symlink():
        raise UserError(f"{path} exists; choose another name")
    if not path.parent.is_dir():
        raise UserError(f"{path.parent}: no such folder")
    write_whole_text(path, start_text(dim, dry))


def start_text(dim: int, dry: bool) -> str:
    """The text of the scenario."""
    lines = (STARTS / ("dry.toml" if dry else "wet.toml")).read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not (mark := MARK.search(line)) or mark[1] == str(dim)]
    return "\n".join(MARK.sub("", line).rstrip() for line in kept) + "\n"
