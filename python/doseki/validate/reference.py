"""Measured data, which are not part of the project: they lie beside its folder, or nowhere."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[3]
FOLDER = ROOT.parent / "shared" / "data"  # its README says where each file comes from


def missing_files(files: Sequence[str]) -> list[str]:
    """Which of the files are not here."""
    return [file for file in files if not (FOLDER / file).is_file()]


def read_columns(file: str, delimiter: str | None = ",", header: int = 0) -> np.ndarray:
    """The columns of a table of numbers: (columns, rows); lines that begin with # are comments."""
    return np.loadtxt(FOLDER / file, delimiter=delimiter, skiprows=header, ndmin=2).T
