"""Maps and sections of a run on several ranks: those of one, to rounding."""

from __future__ import annotations

import numpy as np
import pytest
from tests.driver.test_maps import COLLAPSE, NAMES, SOUTH, WEST

import doseki
from doseki.geodata.raster import read_raster

SECTION = f"""
[gauge.line]
kind = "section"
left = [{WEST + 0.5}, {SOUTH + 0.5}]
right = [{WEST + 0.5}, {SOUTH}]
interval = 0.01
"""


@pytest.mark.minutes
def test_maps_and_sections_on_two_ranks(command, tmp_path):
    """Stopped on two ranks as well, and gone on with on one."""
    file = tmp_path / "collapse.toml"
    file.write_text(COLLAPSE + SECTION)

    def run(ranks, folder, *more):
        arguments = ("-o", folder, "--no-figures", "--threads", 1, *more)
        done = command(ranks, "run", file, *arguments)
        assert done.returncode == 0, done.stderr

    run(1, tmp_path / "one")
    run(2, tmp_path / "two")
    run(2, tmp_path / "both", "--set", "time_max=0.06")
    more = ("--no-figures", "--threads", 1, "--set", "time_max=0.12")
    assert command(1, "resume", tmp_path / "both", *more).returncode == 0
    runs = {name: doseki.load(tmp_path / name) for name in ("one", "two", "both")}
    for name in NAMES:
        found = {key: read_raster(tmp_path / key / f"maps/{name}.asc").values for key in runs}
        scale = np.nanmax(np.abs(found["one"])) or 1.0
        for key in ("two", "both"):
            np.testing.assert_allclose(found[key], found["one"], atol=1e-8 * scale, err_msg=name)
    assert found["one"].shape == (5, 10)
    expected = runs["one"].gauges["line"]
    for key in ("two", "both"):
        gauge = runs[key].gauges["line"]
        for column in expected:
            np.testing.assert_allclose(gauge[column], expected[column], atol=1e-8, err_msg=column)
