"""Numbers of others to compare with: tables in data/, each with its source in its first lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np

DATA = Path(__file__).resolve().parent / "data"


def read_columns(file: str) -> np.ndarray:
    """The columns of a table of numbers: (columns, rows); lines that begin with # are comments."""
    return np.loadtxt(DATA / file, delimiter=",", ndmin=2).T
