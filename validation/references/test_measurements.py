"""The shipped tables against the full records that they were reduced from."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.series import first_above, impulse
from doseki.validate.reference import read_columns

from .reduce_measurements import FOLDER, RECORDS, SHARE, broken_line

# What a case resolves, over the scale it judges by: 5 % of a level, 15 % of a peak, the width of
# the band of impulses (0.97 of 2.6).  A reduction may take a tenth of it.
LEVEL, PRESSURE, IMPULSE = 0.005, 0.015, 0.003
SCALES = {
    "kleefsman-2005-p1.csv": (11239.4, PRESSURE),
    "kleefsman-2005-p2-p4.csv": (8126.0, PRESSURE),
    "kleefsman-2005-p5-p6.csv": (2080.0, PRESSURE),
    "kleefsman-2005-p7-p8.csv": (2031.0, PRESSURE),
    "kleefsman-2005-levels.csv": (0.55, LEVEL),
    "kleefsman-2005-levels-h1-h3.csv": (0.55, LEVEL),
    "lobovsky-2014-sensor-2.csv": (1.871, PRESSURE),
    "lobovsky-2014-sensor-3.csv": (1.518, PRESSURE),
}


@pytest.fixture
def record(request):
    """A record with its times and curves; skips the test where it is not here."""
    found = RECORDS[request.param]
    if not (FOLDER / found.file).is_file():
        pytest.skip(f"the full records are not here: no {FOLDER / found.file}")
    return request.param, found, *found.read(FOLDER)


EACH = pytest.mark.parametrize("record", RECORDS, indirect=True)
PEAKED = [name for name, found in RECORDS.items() if found.peak is not None]


@EACH
def test_the_table_is_the_reduced_record(record):
    name, found, _, _ = record
    times, values = found.reduced(FOLDER)
    assert pytest.approx(np.column_stack([times, values]), rel=1e-4) == read_columns(name).T


@EACH
def test_the_reduction_is_finer_than_what_is_compared(record):
    name, _, times, curves = record
    knots, *columns = read_columns(name)
    scale, share = SCALES[name]
    for column, curve in zip(columns, curves.T, strict=True):
        assert np.mean(np.abs(np.interp(times, knots, column) - curve)) < share * scale
        end = min(6, times[-1])
        whole = impulse(times, curve, 0, end)
        assert impulse(knots, column, 0, end) == pytest.approx(whole, rel=IMPULSE)


@pytest.mark.parametrize("record", PEAKED, indirect=True)
def test_peak_and_arrival_are_kept(record):
    name, found, times, curves = record
    knots, *columns = read_columns(name)
    column, curve = columns[found.peak], curves[:, found.peak]
    assert column.max() == pytest.approx(curve.max(), rel=1e-4)
    arrival = first_above(times, curve, SHARE * curve.max())
    assert first_above(knots, column, SHARE * column.max()) == pytest.approx(arrival, abs=1e-4)


def test_a_broken_line_is_found_again():
    times = np.linspace(0, 8, 801)
    curves = np.interp(times, [0, 2, 3, 8], [0, 1, -1, 0])[:, None]
    knots, values = broken_line(times, curves, 5, [])
    assert np.interp(times, knots, values[:, 0]) == pytest.approx(curves[:, 0], abs=1e-9)
    shifted, moved = broken_line(times + 1, 3 * curves + 2, 5, [])
    assert shifted == pytest.approx(knots + 1)
    assert moved == pytest.approx(3 * values + 2, abs=1e-9)
