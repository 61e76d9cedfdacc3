"""Scenarios made and changed in Python are those of files, and so is what is said of them."""

from __future__ import annotations

import copy
import pickle
import tomllib
from pathlib import Path, PurePosixPath

import numpy as np
import pytest

import doseki
from doseki.scenario.load import load_scenario
from doseki.scenario.reading.files import scenario_folder
from doseki.util.toml_writer import to_toml

from ..shipped import NAMES
from ..small_scenarios import BLOCK, MINIMAL

PARTS = tomllib.loads(BLOCK)["body"]
TOP = tomllib.loads(MINIMAL)
PARAMETERS = {"depth": {"value": "50 cm", "unit": "m", "min": 0.1}, "count": 2}


def block(**keys):
    """A block of water, whose height is a parameter."""
    tables = {"parameters": PARAMETERS, "body": {"block": PARTS["block"] | {"max": [1, "= depth"]}}}
    return doseki.Scenario(TOP | tables | keys)


def refusal(make):
    """The sentence with which something is refused."""
    with pytest.raises(doseki.UserError) as caught:
        make()
    text = str(caught.value)
    assert "\n" not in text
    return text


@pytest.mark.parametrize("name", NAMES)
def test_tables_are_read_as_the_file_that_holds_them(name, monkeypatch):
    monkeypatch.chdir(scenario_folder())  # where the files are that they name
    table = tomllib.loads(Path(f"{name}.toml").read_text(encoding="utf-8"))
    expected = load_scenario(name).effective_toml()
    assert doseki.Scenario(table).to_toml(evaluated=True) == expected
    assert doseki.Scenario(**table).to_toml(evaluated=True) == expected
    assert doseki.Scenario(name).to_toml(evaluated=True) == expected


@pytest.mark.parametrize("evaluated", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_what_is_saved_is_the_same_scenario_wherever_it_lies(name, evaluated, tmp_path):
    given = doseki.Scenario(name, time_max="= 3*time_out")
    again = doseki.Scenario(given.save(tmp_path / "sub.toml", evaluated))
    texts = (each.to_toml(evaluated=True) for each in (again, given))
    assert tomllib.loads(next(texts)) == tomllib.loads(next(texts))


def test_a_saved_scenario_keeps_its_parameters_alive(tmp_path):
    path = block().changed(depth=0.4).save(tmp_path / "block.toml")
    assert load_scenario(path).body["block"].max.tolist() == [1, 0.4]
    assert load_scenario(path, ["depth=0.7"]).body["block"].max.tolist() == [1, 0.7]
    fixed = block().save(tmp_path / "fixed.toml", evaluated=True)
    assert load_scenario(fixed, ["depth=0.7"]).body["block"].max.tolist() == [1, 0.5]


FAULTS = {
    "a number out of range": {"dp": -1},
    "an unknown key": {"time_mx": 1},
    "a word for a number": {"dp": "fine"},
    "a wrong unit": {"dp": "3 kg"},
    "an expression": {"dp": "= depht/4"},
    "a part without what it needs": {"body": {"block": {"shape": "box", "min": [0, 0]}}},
    "a wrong shape": {"body": {"block": PARTS["block"] | {"shape": "bx"}}},
    "an entry of a list": {"gravity": [0, "g"]},
    "two that exclude each other": {"xi": 1, "xi_height": 2},
    "a gauge": {"gauge": {"g": {"kind": "pressure"}}},
    "a material that is unknown": {"body": {"block": PARTS["block"] | {"material": "watr"}}},
}


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
def test_the_message_is_that_of_a_file_without_its_name(fault, tmp_path):
    tables = TOP | {"body": PARTS} | fault
    (tmp_path / "case.toml").write_text(to_toml(tables), encoding="utf-8")
    of_file = refusal(lambda: load_scenario(tmp_path / "case.toml"))
    of_table = refusal(lambda: doseki.Scenario(tables))
    assert of_table.startswith("scenario: ")
    assert of_table.removeprefix("scenario") == of_file[of_file.index(": ") :]


class Odd:
    """Something that no scenario holds."""


LOOP: dict = {}
LOOP["loop"] = LOOP
STRANGE = {
    "nan": (float("nan"), "scenario: body.block.max.1: nan is no number"),
    "nan of numpy": (np.float64("nan"), "nan is no number"),
    "none": (None, "None is no value"),
    "a set": ({1, 2}, "a value of type set is not allowed"),
    "complex": (1j, "a value of type complex is not allowed"),
    "an object": (Odd(), "test_scenario.Odd is not allowed"),
    "a key that is no word": ({1: 2}, "scenario: body.block.max.1: the key 1 must be a word"),
    "half a character": ("\ud800", "has characters that no file can hold"),
    "endless": (LOOP, "nested more than 32 deep"),
    "masked": (np.ma.array([1.0, 2.0], mask=[False, True]), "entries of the array are masked"),
}


@pytest.mark.parametrize(("value", "said"), STRANGE.values(), ids=STRANGE)
def test_values_that_no_file_can_hold_are_refused_by_key(value, said):
    body = {"block": PARTS["block"] | {"max": [1, value]}}
    text = refusal(lambda: doseki.Scenario(TOP | {"body": body}))
    assert said in text


def test_values_of_numpy_tuples_and_paths():
    body = PARTS["block"] | {"min": np.zeros(2), "max": (np.float32(1), np.int64(1))}
    tables = {"dim": np.int8(2), "dp": np.float64(0.1), "title": np.str_("a"), "body": {"b": body}}
    made = doseki.Scenario(TOP | tables, periodic=np.array([], str))
    assert made["body"]["b"]["max"] == [1, 1]
    assert (made["dp"], type(made["dim"])) == (0.1, int)
    assert "particles.csv" in refusal(
        lambda: doseki.Scenario(
            TOP | {"body": {"b": {"shape": "file", "file": PurePosixPath("particles.csv")}}}
        )
    )


def test_files_are_relative_to_where_they_were_named(tmp_path, monkeypatch):
    rows = "x,y,vx,vy,mass,density,material\n0,0,0,0,10,1000,water\n"
    body = {"body": {"b": {"shape": "file", "file": "p.csv"}}}
    here, there = tmp_path / "here", tmp_path / "there"
    for folder, shift in ((here, 0), (there, 1)):
        folder.mkdir()
        (folder / "p.csv").write_text(rows.replace("0,0,0,0", f"{shift},0,0,0"))
    monkeypatch.chdir(here)
    made = doseki.Scenario(TOP | body)
    made.save(there / "case.toml")
    monkeypatch.chdir(there)
    for scenario in (made, made.changed(dp=0.2), doseki.Scenario(there / "case.toml")):
        assert scenario.checked.particle_tables["b"].position[0, 0] == 0
        assert scenario.checked.inputs[0].path == (here / "p.csv").resolve()
    moved = made.changed({"body.b.file": "p.csv"})
    assert moved.checked.particle_tables["b"].position[0, 0] == 1


def test_a_change_reaches_what_depends_on_it():
    given = doseki.Scenario("collision")
    changed = given.changed({"body.left.fill": "single"}, speed=3)
    assert changed["body.right.velocity"] == [-3, 0]
    assert changed["xi"] == pytest.approx(given["xi"] / 2)
    assert given["body.right.velocity"] == [-6, 0]  # and leaves the other as it was
    settings = ["speed=3", "body.left.fill=single"]
    assert changed.to_toml(evaluated=True) == load_scenario("collision", settings).effective_toml()
    assert doseki.Scenario("collision", speed=3)["xi"] == changed["xi"]
    assert doseki.Scenario(given, speed=3)["xi"] == changed["xi"]


def test_changes_are_made_in_their_order():
    made = block().changed({"body.block.min": [0.1, 0]}).changed(body={"block": {"min": [0.2, 0]}})
    assert made["body.block.min"] == [0.2, 0]
    assert made.changed({"body.block.min": [0.3, 0]})["body.block.min"] == [0.3, 0]


def test_tables_are_laid_over_those_there_are():
    weir = {"shape": "box", "material": "basalt", "fixed": True, "min": [2, 0], "max": [2.2, 1]}
    made = block().changed(
        {"body.weir": weir, "contact.overlap": 0.02}, scheme="resolved", speed_max=3
    )
    assert list(made["body"]) == ["block", "weir"]
    again = made.changed(body={"block": {"velocity": [1, 0]}, "weir": {"max": [2.2, 2]}})
    assert again["body.block.max"] == [1, 0.5]
    assert again["body.weir.max"] == [2.2, 2]
    assert again["body.weir.min"] == [2, 0]
    assert list(again.without("body.weir")["body"]) == ["block"]
    more = again.changed({"parameters.width": 3, "parameters.depth": {"help": "of water"}})
    assert (more["width"], more["depth"]) == (3, 0.5)
    assert more.changed(material={"mud": {"law": "fluid", "rho0": 1500, "speedsound": 1400}})


def test_a_key_takes_the_place_of_its_rival():
    assert block(slope=20).changed(gravity=[0, -1]).checked.slope is None
    with_times = block(figure={"a": {"kind": "snapshot", "times": [0.5]}})
    assert with_times.changed(figure={"a": {"when": "first"}})["figure.a.when"] == "first"


WRONG = {
    "an unknown key": (
        {"dept": 1},
        "(dept): not a key of this scenario; did you mean depth?",
    ),
    "a value": ({"depth": 0.01}, "0.01 is out of range; must be 0.1 m or more"),
    "a kind": ({"depth": True}, "changed(depth): depth = True must be a number"),
    "an unknown table": ({"body.blck.min": [0, 0]}, "no table body.blck; did you mean body.block?"),
    "a key of a new table": ({"body.b": {"shape": "box"}}, "changed(body.b): body.b.material is m"),
    "a key of a table": (
        {"body": {"block": {"min": "x"}}},
        'changed(body): body.block.min = "x" is no',
    ),
    "no table": ({"body.block": 3}, "changed(body.block): expected body.block.KEY=value"),
    "nan": ({"depth": np.nan}, "changed(depth): depth: nan is no number"),
}


@pytest.mark.parametrize(("changes", "said"), WRONG.values(), ids=WRONG)
def test_a_change_that_cannot_be_is_named(changes, said):
    assert said in refusal(lambda: block().changed(changes))


def test_what_is_taken_away_must_be_there():
    assert "did you mean block?" in refusal(lambda: block().without("body.blok"))
    assert "time_max is missing" in refusal(lambda: block().without("time_max"))
    assert "depth" in refusal(lambda: block().without("depth"))  # the body needs it


def test_it_cannot_be_changed_in_place():
    made = block()
    made["body"]["block"]["max"][0] = 7
    assert made["body.block.max"] == [1, 0.5]
    with pytest.raises(TypeError):
        made["dp"] = 3
    tables = TOP | {"body": copy.deepcopy(PARTS)}
    given = doseki.Scenario(tables)
    tables["body"]["block"]["max"][0] = 7
    assert given.changed(dp=0.05)["body.block.max"] == [1, 0.5]


def test_it_reads_like_a_dictionary():
    made = block()
    assert set(made) >= {"dim", "dp", "body", "parameters"}
    assert made["material.water.rho0"] == made["material"]["water"]["rho0"] == 1000
    assert made["parameters"]["depth"]["value"] == made["depth"] == 0.5
    assert "dpp" not in made
    with pytest.raises(KeyError, match="did you mean dp"):
        made["dpp"]
    assert "2-D, ueta2022, dp = 0.1 m" in repr(made)


def test_copies_and_pickles_are_the_same(tmp_path):
    made = block().changed(depth=0.3).without("parameters.count")
    for other in (pickle.loads(pickle.dumps(made)), copy.deepcopy(made)):
        assert other == made
        assert other.changed(depth=0.4)["body.block.max"] == [1, 0.4]


def test_one_extends_another(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "base.toml").write_text(MINIMAL + BLOCK)
    made = doseki.Scenario({"extends": "base.toml", "dp": 0.05})
    assert (made["dp"], made["body.block.max"]) == (0.05, [1, 0.5])
    assert "scenario: extends = 3" in refusal(lambda: doseki.Scenario({"extends": 3}))
    (tmp_path / "base.toml").write_text('extends = "base.toml"\n' + MINIMAL)
    assert "leads back" in refusal(lambda: doseki.Scenario({"extends": "base.toml"}))


def test_what_is_no_scenario_is_refused(tmp_path):
    assert "did you mean flume?" in refusal(lambda: doseki.Scenario("flum"))
    assert "not a int" in refusal(lambda: doseki.Scenario(3))
    assert "none.toml" in refusal(lambda: doseki.Scenario(tmp_path / "none.toml"))


def test_check_says_what_a_run_takes():
    found = block(speed_max=3, scheme="resolved").check(threads=1)
    assert found.particles == 50
    assert found.steps > 1
    assert min(found.memory, found.disk, found.timestep, found.seconds) > 0
    assert "particles" in str(found)
    assert all(f"warning: {text}" in str(found) for text in found.warnings)


def test_an_attribute_of_a_scenario_cannot_be_set():
    with pytest.raises(AttributeError, match=r"changed\(dp=3\) makes another one"):
        block().dp = 3


@pytest.mark.parametrize("threads", [0, -5, "a", 1.5, True])
def test_check_refuses_what_is_no_number_of_threads(threads):
    with pytest.raises(doseki.UserError, match=r"threads = .*; allowed: a whole number from 1 on"):
        block().check(threads)


def test_what_is_of_another_kind_is_told_in_a_sentence():
    made = block()
    for call in (lambda: made.changed(3), lambda: made.without(3), lambda: made.save(None)):
        with pytest.raises(doseki.UserError, match=r"a key must be a word|allowed: a "):
            call()
    with pytest.raises(KeyError, match="the scenario has no 3"):
        made[3]
    for call in (lambda: doseki.Scenario(None), lambda: doseki.run(None)):
        with pytest.raises(doseki.UserError, match="a scenario is a name, a path or a dictionary"):
            call()
