"""Study files: what they mean, and how a wrong one is refused."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.scenario.reading.overrides import changes_of
from doseki.studies.plan.axes import Axis, written
from doseki.studies.plan.file import read_plan
from doseki.studies.plan.sampling import points, remarks
from doseki.studies.plan.tables import Sample

from .small_study import SCENARIO, STUDY, write_study

RANGE = 'min = "5 m/s2"\nmax = 20'
OBSERVED = '[observation.a]\nkind = "value"\nresult = "speed"\nvalue = 1\nerror = 0.1\n'
SERIES = '[observation.a]\nkind = "series"\nfile = "o.csv"\ngauge = "centre"\ncolumn = "y"\n'
CALIBRATE = '[calibrate]\nmethod = "shgo"\n'

# What is changed in the study, and words of the answer.
REFUSED = {
    "an unknown key": (('kind = "grid"', 'kind = "grid"\ncuont = 3'), "sample.cuont", "count"),
    "an unknown table": (("[sample]", "[sampel]"), "sampel is not a known key", "sample"),
    "an unknown kind": (('kind = "gauge"', 'kind = "guage"'), "not a kind of result", "gauge?"),
    "no kind": (('kind = "gauge"\n', ""), "result.speed.kind is missing", "history"),
    "no such gauge": (('gauge = "centre"', 'gauge = "center"'), "no gauge", "did you mean centre"),
    "no such column": (('"velocity_y"', '"velocity_z"'), "no column", "velocity_y"),
    "no such parameter": (("vary.pull", "vary.pul"), "vary.pul", "did you mean pull"),
    "no such scenario": (('"./fall.toml"', '"valey"'), "no scenario", "did you mean valley"),
    "a range without count": (("values = [5, 10, 20]", "min = 5\nmax = 20"), "count", "a grid"),
    "a range upside down": (
        ("values = [5, 10, 20]", "min = 9\nmax = 2\ncount = 2"), "vary.pull.max", "greater than"
    ),
    "two kinds of units": (("values = [5, 10, 20]", RANGE), "vary.pull.max", "same kind of unit"),
    "no number": (('values = [5, 10, 20]', 'min = "x"\nmax = 2'), "vary.pull.min", "3 L/s"),
    "a logarithm of nothing": (
        ("values = [5, 10, 20]", 'min = 0\nmax = 1\nscale = "log"'), "vary.pull.min", "0"
    ),
    "a value that cannot be": (("[5, 10, 20]", '["2 kg"]'), "vary.pull", "kg"),
    "a value twice": (("[5, 10, 20]", '[5, "500 cm/s2"]'), "vary.pull.values", "are one value"),
    "a count of a grid": (('"grid"', '"grid"\ncount = 5'), "sample.count", "does not go"),
    "no count": (('"grid"', '"sobol"'), "sample.count", "is missing"),
    "nothing to read": ((STUDY[STUDY.index("[result") :], ""), "nothing is read", "result"),
    "a name that no file has": (("[sample]", '[bands."a/b"]\nkind = "series"\ngauge = "centre"\n'
                                'column = "y"\n[sample]'), '"a/b" cannot be a name', "bands"),
    "a result of such a name": (("result.speed", 'result."../x"'), "cannot be a name", "result"),
    "a table of tables": (
        ("[sample]", "[set]\nmaps = { cell = 1 }\n[sample]"), "line 6: set: --set maps"
    ),
    "what is set and varies": (("[sample]", "[set]\npull = 3\n[sample]"), "set.pull", "varies"),
    "a time without at": (('"velocity_y"', '"velocity_y"\nat = 3'), "speed.at", "goes with"),
    "no [maps]": (('kind = "gauge"\ngauge = "centre"\ncolumn = "velocity_y"',
                   'kind = "run_out"'), "keeps no maps", "[maps]"),
    "a calibration of a list": (("[sample]", f"{OBSERVED}{CALIBRATE}[sample]"), "values", "range"),
    "a calibration of nothing": (("[sample]", f"{CALIBRATE}[sample]"), "no [observation]", "near"),
    "an absurd count": (('"grid"', '"sobol"\ncount = 1000000000'), "sample.count", "100000"),
    "no such result": (
        ("[sample]", OBSERVED.replace('"speed"', '"sped"') + "[sample]"), "sped", "speed"
    ),
    "no such file": (("[sample]", SERIES + "error = 1\n[sample]"), "o.csv", "no such file"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_wrong_study_is_refused(name, tmp_path):
    (old, new), *words = REFUSED[name]
    assert old in STUDY
    path = write_study(tmp_path, STUDY.replace(old, new))
    with pytest.raises(UserError) as caught:
        read_plan(path)
    text = str(caught.value)
    assert str(path) in text
    for word in words:
        assert word in text


@pytest.mark.parametrize("path", ['"body.block.jitter"', "body.block.jitter"])
def test_a_path_may_stand_in_quotes_or_not(path, tmp_path):
    text = STUDY.replace("vary.pull", f"vary.{path}").replace("[5, 10, 20]", "[0.1, 0.2]")
    plan = read_plan(write_study(tmp_path, text))
    assert [axis.name for axis in plan.axes] == ["body.block.jitter"]
    assert plan.settings_of((0.1,)) == ["body.block.jitter=0.1"]


ARRAY = "\narray = { count = [2, 1], step = [1, 0] }\n"
TURNS = "array = { turns = 3, about = [0, -1] }"
GIVEN = {
    f"body.block.{TURNS}": "body.block.array",
    TURNS.replace("array", '"body.block.array"'): "body.block.array",
    f'[set."body.block"]\n{TURNS}': "body.block.array",
    "body.block.array.count = [3, 1]": "body.block.array.count",
    "[set.body.block.array]\ncount = [3, 1]": "body.block.array.count",
}


@pytest.mark.parametrize("given", GIVEN)
def test_what_is_set_acts_as_on_the_command_line(given, tmp_path):
    """A table in braces takes the place of the one that was there; a path changes a key of it."""
    scenario = SCENARIO.replace("max = [0.6, 0.3]", f"max = [0.6, 0.3]{ARRAY}")
    study = STUDY.replace("[sample]", f"[set]\n{given}\n[sample]")
    plan = read_plan(write_study(tmp_path, study, scenario))
    assert [text.partition("=")[0] for text in plan.settings] == [GIVEN[given]]
    assert len(plan.scenario.body) == 3


def test_a_choice_that_is_set_is_one_value(tmp_path):
    study = STUDY.replace("[sample]", "[set]\ntime_max = { d2 = 0.01, d3 = 0.02 }\n[sample]")
    assert read_plan(write_study(tmp_path, study)).scenario.time_max == 0.01


VALUES = [{"a": 1, "b": ["x", {"c": 'a"b'}]}, [1, [2.5, True]], "a = [1]", {}, []]


@pytest.mark.parametrize("value", VALUES)
def test_what_is_written_is_read_by_set(value):
    (change,) = changes_of([f"key={written(value)}"])
    assert change.value == value


def test_units_go_to_the_scenario(tmp_path):
    text = STUDY.replace("values = [5, 10, 20]", 'min = "500 cm/s2"\nmax = "20 m/s2"\ncount = 2')
    plan = read_plan(write_study(tmp_path, text))
    assert plan.points() == [(5.0,), (20.0,)]
    assert plan.settings_of((5.0,)) == ["pull=5.0 m/s2"]
    assert plan.axes[0].label == "pull [m/s2]"
    assert plan.units() == {"speed": "m/s"}


@pytest.mark.parametrize(
    ("vary", "label", "setting"),
    [
        ("[vary.pull]\nvalues = [5, 10]", "pull [m/s2]", "pull=5"),
        ("[vary.pull]\nmin = 5\nmax = 10\ncount = 2", "pull [m/s2]", "pull=5.0"),
        ('[vary.pull]\nvalues = ["500 cm/s2"]', "pull [m/s2]", 'pull="500 cm/s2"'),
        ('[vary."parameters.pull.value"]\nvalues = [5]', "parameters.pull.value [m/s2]", None),
        ("[vary.dp]\nvalues = [0.1, 0.05]", "dp [m]", "dp=0.1"),
        ("[vary.cfl_force]\nvalues = [0.1]", "cfl_force", "cfl_force=0.1"),
        ('[vary.scheme]\nvalues = ["resolved"]', "scheme", 'scheme="resolved"'),
    ],
)
def test_numbers_have_the_unit_that_the_scenario_declares(tmp_path, vary, label, setting):
    text = STUDY.replace("[vary.pull]\nvalues = [5, 10, 20]", vary)
    plan = read_plan(write_study(tmp_path, text))
    assert plan.axes[0].label == label
    if setting is not None:  # the scenario is told what the study says, no more
        assert plan.settings_of(plan.points()[0]) == [setting]


AXES = [Axis("a", low=1.0, high=100.0, log=True), Axis("b", choices=("x", "y"))]


def test_values_with_units_are_numbers_in_the_unit_of_their_column():
    axis = Axis("depth", choices=("10 cm", "0.2 m", 0.3))
    assert axis.label == "depth [m]"
    assert [axis.cell(value) for value in axis.choices] == [0.1, 0.2, 0.3]


def test_a_grid_has_every_pair():
    grid = points([Axis("a", low=1, high=100, log=True, count=3), AXES[1]], Sample(kind="grid"))
    assert grid == [(1, "x"), (1, "y"), (10, "x"), (10, "y"), (100, "x"), (100, "y")]


@pytest.mark.parametrize("kind", ["latin_hypercube", "sobol"])
def test_samples_fill_all_shares_alike(kind):
    sample = Sample(kind=kind, count=16, seed=3)
    found = points(AXES, sample)
    assert found == points(AXES, sample)
    assert found != points(AXES, Sample(kind=kind, count=16, seed=4))
    shares = np.log(np.array([a for a, _ in found])) / np.log(100)
    assert sorted((16 * shares).astype(int)) == list(range(16))  # one in each share
    assert [b for _, b in found].count("x") == 8


def test_a_sobol_sequence_goes_on_where_it_was():
    few, more = (Sample(kind="sobol", count=n) for n in (8, 16))
    assert points(AXES, more)[:8] == points(AXES, few)
    assert not remarks(few)
    assert "16" in remarks(Sample(kind="sobol", count=9))[0]
