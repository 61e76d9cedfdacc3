"""What pages tell a reader to type works: scenarios are read, commands exist, all of it runs."""

from __future__ import annotations

import ast

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

from .pages import PAGES, START, Page, base_scenario, unknown_options

pages = pytest.mark.parametrize("name", PAGES)


@pages
def test_scenarios_are_read(name, tmp_path):
    for path, settings in Page(name, tmp_path).write_scenarios():
        if "[start]" in path.read_text():  # needs a run that is there: run below
            continue
        load_scenario(str(path), settings)


@pages
def test_commands_exist(name, tmp_path):
    assert [w for words in Page(name, tmp_path).commands for w in unknown_options(words)] == []


@pages
def test_python_is_python(name, tmp_path):
    for block in Page(name, tmp_path).blocks:
        if block.language == "python":
            ast.parse(block.text)


@pages
def test_blocks_say_what_they_are(name, tmp_path):
    languages = {block.language for block in Page(name, tmp_path).blocks}
    assert languages <= {"console", "toml", "python", "text"}


def test_an_option_that_is_not_there_is_found():
    assert unknown_options(["./doseki", "run", "x.toml", "--ouput", "o"]) == ["--ouput"]
    assert unknown_options(["./doseki", "walk", "x.toml"]) == ["walk"]


def test_a_key_that_is_not_there_is_found(tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text(base_scenario().replace("turbulence", "turbulance"))
    with pytest.raises(UserError, match="turbulence"):
        load_scenario(str(path))


@pytest.mark.minutes
def test_the_first_page_is_checked(tmp_path):
    page = Page(START, tmp_path)
    for _ in page.write_scenarios():
        pass
    page.run_command("./doseki check my-channel.toml")
    page.run_command("./doseki run my-channel.toml -o out --set time_max=0.1")
    page.run_command("./doseki plot out --movie channel.gif --colour speed")
    assert (tmp_path / "channel.gif").stat().st_size > 1000


def test_a_boulder_strikes_a_sill(tmp_path):
    """The ground that the page prints bears the scene, whose sill breaks in what it runs."""
    page = Page("how-to/breaking.md", tmp_path)
    assert "sill.toml" in {path.name for path, _ in page.write_scenarios()}
    scenario = load_scenario(str(tmp_path / "sill.toml"), ["time_max=0.012"])
    assert scenario.bed is not None
    assert filled_simulation(scenario).warnings == []
    run_scenario(scenario, tmp_path / "sill", RunOptions(threads=1))
    table = load(tmp_path / "sill")[-1].grains
    assert np.count_nonzero(table["parent"] >= 0) > 10


@pytest.fixture(scope="module")
def first_run(tmp_path_factory):
    """The folder of the first page after all that it says."""
    folder = tmp_path_factory.mktemp("start")
    Page(START, folder).run()
    return folder


@pytest.mark.full
@pages
def test_all_of_a_page_works(name, tmp_path, first_run):
    """In the folder of the first page, which has the run that others read."""
    if name == START:
        assert (first_run / "out" / "report.html").is_file()
        assert (first_run / "channel.gif").is_file()
        return
    page = Page(name, tmp_path)
    page.begin_with(first_run)
    page.run()
