"""What a record becomes: arrays of xarray and tables of pandas that agree with it, and pictures."""

from __future__ import annotations

import importlib.util
import sys
import warnings

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot

import doseki
from doseki.api import datasets
from doseki.measure.census.census import take_census
from doseki.record.fields import FIELD_BY_KEY


@pytest.fixture(autouse=True)
def _closed_figures():
    yield
    pyplot.close("all")


def test_a_dataset_holds_what_the_snapshots_do(recorded):
    fields = ["position", "density", "stress", "motion"]
    found = recorded.to_xarray(fields)
    assert found["stress"].dims == ("time", "particle", "row", "column")
    assert found["position"].sizes["axis"] == 2
    counts = set()
    for time in recorded.times:
        there, snapshot = found.sel(time=time), recorded.at(time)
        there = there.isel(particle=there["present"].values)
        assert there["particle"].values.tolist() == np.sort(snapshot["id"]).tolist()
        for name in fields:
            assert np.array_equal(there[name], snapshot[name][np.argsort(snapshot["id"])]), name
        assert np.array_equal(there["material"], snapshot["material"][np.argsort(snapshot["id"])])
        assert np.array_equal(there["body"], snapshot["body"][np.argsort(snapshot["id"])])
        counts.add(len(snapshot["id"]))
    assert len(counts) > 1  # particles enter and leave
    gone = ~found["present"].values
    assert gone.any()
    assert np.isnan(found["density"].values[gone]).all()
    assert (found["motion"].values[gone] == -1).all()


def test_a_dataset_says_its_units(recorded):
    found = recorded.to_xarray()
    assert set(found) == {*datasets.DEFAULT, "present"}
    for name in datasets.DEFAULT:
        field = FIELD_BY_KEY[name]
        assert found[name].attrs == {"units": field.unit_in(2), "long_name": field.doc}
    assert found["mass"].attrs["units"] == "kg/m"
    assert found["time"].attrs == {"units": "s", "long_name": "time"}
    assert found["axis"].values.tolist() == ["x", "y"]
    assert found.attrs["title"] == "channel"


def test_times_and_fields_are_chosen(recorded):
    times = recorded.times
    assert recorded.to_xarray("velocity", times[2])["time"].values.tolist() == [times[2]]
    chosen = recorded.to_xarray(["velocity"], [times[3], times[1]])
    assert chosen["time"].values.tolist() == [times[1], times[3]]
    part = recorded.to_xarray(["velocity"], slice(times[1], times[3]))
    assert part["time"].values.tolist() == times[1:4].tolist()
    assert recorded.to_pandas(times=slice(None, times[1]))["time"].max() == times[1]


WRONG = {
    "an unknown field": ({"fields": ["velocty"]}, "did you mean velocity"),
    "what is always there": ({"fields": ["material"]}, "material is always there"),
    "a time outside": ({"times": 99.0}, "outside the record"),
    "no time": ({"times": slice(50, 60)}, "no snapshot at these times"),
    "a step": ({"times": slice(0, 1, 2)}, "has no step"),
}


@pytest.mark.parametrize(("wishes", "said"), WRONG.values(), ids=WRONG)
def test_what_is_not_there_is_refused(recorded, wishes, said):
    for make in (recorded.to_xarray, recorded.to_pandas):
        with pytest.raises(doseki.UserError, match=said):
            make(**wishes)


def test_what_would_fill_the_memory_is_refused(recorded, monkeypatch):
    monkeypatch.setattr(datasets, "available_bytes", lambda: 50_000)
    for make in (recorded.to_xarray, recorded.to_pandas):
        with pytest.raises(doseki.ResourceError, match="name fewer fields"):
            make(["stress"])
    assert recorded.to_xarray(["density"], times=0.0)


def test_a_table_has_a_row_for_each_particle_and_time(recorded):
    found = recorded.to_pandas(["velocity", "stress", "density"])
    for time in recorded.times:
        rows, snapshot = found[found["time"] == time], recorded.at(time)
        assert np.array_equal(rows["id"], snapshot["id"])
        assert np.array_equal(rows["velocity_y"], snapshot["velocity"][:, 1])
        assert np.array_equal(rows["stress_xy"], snapshot["stress"][:, 0, 1])
        assert np.array_equal(rows["stress_zz"], snapshot["stress"][:, 2, 2])
        assert np.array_equal(rows["density"], snapshot["density"])
        assert rows["material"].tolist() == snapshot["material"].tolist()
    units = found.attrs["units"]
    assert set(units) == set(found)
    assert (units["velocity_x"], units["stress_xx"], units["time"]) == ("m/s", "Pa", "s")


def test_history_and_gauges(recorded):
    history = recorded.history.to_pandas()
    assert history.index.name == "time"
    assert np.array_equal(history["kinetic_energy"], recorded.history["kinetic_energy"])
    units = history.attrs["units"]
    expected = {"kinetic_energy": "J/m", "mass_left": "kg/m", "momentum_x": "kg/s", "dt": "s"}
    expected |= {"n_water": "", "share_wait": "", "impulse_y": "kg/s", "av_dissipation": "J/m"}
    assert {name: units[name] for name in expected} == expected
    assert set(units) == set(recorded.history)
    rate = recorded.gauges["rate"]
    assert np.array_equal(rate.to_pandas()["discharge"], rate["discharge"])
    assert rate.to_xarray()["discharge"].dims == ("time",)
    assert rate.to_xarray()["discharge"].attrs["units"] == rate.units["discharge"] == "m2/s"


def test_a_profile_has_two_dimensions(recorded):
    gauge = recorded.gauges["profile"]
    found = gauge.to_xarray()
    assert found["velocity_x"].dims == ("time", "height")
    assert found.sizes["height"] == 4
    for k in (0, 5, len(gauge["time"]) - 1):
        there = found.sel(time=gauge["time"][k], height=gauge["height"][k])
        assert there["fraction"] == gauge["fraction"][k]
    assert found["height"].attrs["units"] == "m"


def test_grains_are_those_of_the_census(recorded):
    census, found = take_census(recorded).table, recorded.grains
    assert len(found) == len(census["time"]) > 0
    assert np.array_equal(found["position_y"], census["position"][:, 1])
    assert np.array_equal(found["grain"], census["id"])
    speed = np.hypot(found["velocity_x"], found["velocity_y"])
    assert np.allclose(found["speed"], speed, rtol=1e-14)
    assert set(found["class"].cat.categories) >= {"waiting", "deposited"}
    units = found.attrs["units"]
    assert set(units) == set(found)
    assert (units["mass"], units["spin_z"]) == ("kg/m", "rad/s")


@pytest.mark.parametrize("package", ["pandas", "xarray"])
def test_a_package_that_is_missing_is_named(recorded, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    makes = {
        "pandas": [recorded.to_pandas, recorded.history.to_pandas, lambda: recorded.grains],
        "xarray": [recorded.to_xarray, recorded.gauges["rate"].to_xarray],
    }
    for make in makes[package]:
        with pytest.raises(doseki.UserError, match=r"needs .*pip install 'doseki\[analysis\]'"):
            make()


def test_a_picture_goes_on_axes_that_are_given(recorded):
    figure, axes = pyplot.subplots(1, 2)
    before, backend = dict(mpl.rcParams), mpl.get_backend()
    assert recorded.plot("velocity_x", 0.0, ax=axes[0]) is axes[0]
    assert recorded.plot("material", ax=axes[1], material="water") is axes[1]
    assert (dict(mpl.rcParams), mpl.get_backend()) == (before, backend)
    assert axes[0].get_title(loc="left") == "t = 0.00 ms" or "t = 0" in axes[0].get_title(
        loc="left"
    )
    all_of_them = recorded.at(0.0)
    assert len(axes[0].collections[0].get_offsets()) == len(all_of_them["id"])
    last = recorded[-1]
    assert len(axes[1].collections[0].get_offsets()) == (last["material"] == "water").sum()
    assert axes[0].child_axes[0].get_ylabel() == "velocity x (m/s)"
    assert len(pyplot.get_fignums()) == 1
    figure.canvas.draw()


def test_a_picture_without_axes_is_on_a_new_figure(recorded):
    axes = recorded.plot("speed", recorded.times[2])
    assert pyplot.get_fignums() == [axes.figure.number]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        axes.figure.canvas.draw()  # and everything fits on it


@pytest.mark.parametrize(
    ("wishes", "said"),
    [
        ({"colour": "sped"}, "did you mean speed"),
        ({"window": "outlt"}, "no window"),
        ({"material": "watr"}, "did you mean water"),
        ({"time": 7.0}, "outside the record"),
    ],
)
def test_a_picture_that_cannot_be_is_refused_and_leaves_no_figure(recorded, wishes, said):
    with pytest.raises(doseki.UserError, match=said):
        recorded.plot(**wishes)
    assert pyplot.get_fignums() == []


def test_figures_are_those_of_the_command(recorded):
    assert recorded.figures == ["overview", "energy", "mass", "flow"]
    assert recorded.figure("energy").axes[0].get_xlabel() == "time (s)"
    assert pyplot.get_fignums() == []
    with pytest.raises(doseki.UserError, match="did you mean energy"):
        recorded.figure("enery")


def test_in_space_a_slice_is_drawn(tmp_path):
    box = {"shape": "box", "material": "water", "min": [0, 0, 0], "max": [0.4, 0.3, 0.2]}
    cube = doseki.Scenario(
        dim=3, dp=0.1, time_max=1e-4, time_out=1e-4, body={"box": box}, periodic=[]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", doseki.DosekiWarning)
        run = doseki.run(cube, tmp_path / "run", threads=1, progress=False)
    axes = run.plot("pressure")
    assert len(axes.collections[0].get_offsets()) == 8  # of 24
    assert "slice at y = 0.15 m" in axes.get_title(loc="left")
    assert run.to_xarray().sizes == {"time": 2, "particle": 24, "axis": 3}


def test_a_run_says_what_it_is(recorded):
    assert "snapshots, done" in repr(recorded)
    assert isinstance(recorded[1:3], list)
    assert importlib.util.find_spec("doseki.api.record")


def test_what_is_of_another_kind_is_told_in_a_sentence(run_folder):
    recorded = doseki.load(run_folder)
    for time in ("a", [0.1], True, None):
        with pytest.raises(doseki.UserError, match=r"time = .*; allowed: a number, in s"):
            recorded.at(time)
    for directory in (None, 3):
        with pytest.raises(doseki.UserError, match=r"directory = .*; allowed: a path"):
            doseki.load(directory)
    with pytest.raises(doseki.UserError, match="changes = 3; allowed: a dictionary"):
        doseki.resume(recorded.directory, 3)
    with pytest.raises(doseki.UserError, match="colour None is not something to draw"):
        recorded.plot(None)
    with pytest.raises(KeyError, match="3 is not a field"):
        recorded[-1][3]
    with pytest.raises(KeyError, match="'lev' is not a gauge of the run"):
        recorded.gauges["lev"]
