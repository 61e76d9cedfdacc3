"""Kinds of gauges: each says what its columns are, and how a figure shows them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from doseki.figures.kinds.registry import draw
from doseki.measure.views import tables
from doseki.record.reader import load
from doseki.record.writer import Recorder
from doseki.scenario.gauges.gauge import Gauge
from doseki.scenario.gauges.kinds import GAUGES
from doseki.scenario.tables.figure import Figure

SCENARIO = """\
schema = 1
dim = 2
dp = 0.1
time_max = 1.0
time_out = 1.0
gravity = [0.0, -9.8]

[gauge.g]
kind = "{kind}"
position = [0.0, 0.0]
{keys}
[figure.f]
kind = "gauge"
gauge = "g"
columns = ["fraction"]
"""


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kind", GAUGES.tables.values())
def test_every_kind_has_columns_of_its_own(kind, dim):
    gauge = kind.model_construct()
    others = [other.model_construct() for other in GAUGES.tables.values() if other is not kind]
    columns = gauge.columns(dim)
    assert next(iter(columns.items())) == ("time", "s")
    assert columns not in [other.columns(dim) for other in others]
    assert set(gauge.curves(dim)) <= set(columns) - {"time"}
    assert gauge.is_profile == ("height" in columns and len(columns) > 2)


def test_a_kind_that_does_not_say_its_columns_has_none():
    class Thermometer(Gauge):
        pass

    with pytest.raises(NotImplementedError):
        Thermometer.model_construct().columns(2)


@pytest.mark.parametrize(
    ("kind", "keys", "xlabel"),
    [
        ("velocity_profile", "length = 1.0\n", "fraction (1)"),
        ("pressure", "", "time (s)"),
    ],
)
def test_the_kind_tells_a_profile_not_the_names_of_columns(tmp_path: Path, kind, keys, xlabel):
    """Both files have a column `fraction`."""
    recorder = Recorder(
        tmp_path / "run", SCENARIO.format(kind=kind, keys=keys), ["water"], ["sea"], 2
    )
    rows = [[t, z, 0.5] for t in (0.0, 1.0) for z in (0.1, 0.2)]
    recorder.gauge("g", ["time [s]", "height [m]", "fraction [1]"], rows)
    run = load(tmp_path / "run")
    drawn = draw(run, "f", tables(run, "figure", Figure)["f"])
    axes = drawn.axes[0]
    assert axes.get_xlabel() == xlabel
    assert len(axes.lines) == (2 if kind == "velocity_profile" else 1)
    np.testing.assert_allclose(
        axes.lines[0].get_xdata(), [0.5, 0.5] if kind == "velocity_profile" else [0, 0, 1, 1]
    )
