"""Files of gauges that are damaged or gone: one sentence that names the file."""

from __future__ import annotations

import shutil

import pytest
from typer.testing import CliRunner

from doseki.cli.app import app
from doseki.errors import UserError

from .scenes import RAIN, run_of

FIGURE = '\n[figure.all]\nkind = "load"\ngauge = "all"\n'


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rain")
    return run_of(folder, RAIN + FIGURE, "time_max=0.03", "time_out=0.03").directory


@pytest.fixture
def run(whole, tmp_path):
    return shutil.copytree(whole, tmp_path / "run")


def called(*arguments):
    return CliRunner().invoke(app, [str(word) for word in arguments])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("when [s],mass_passed [kg/m]\n0,0\n", "'time' is not a column"),
        ("time [s],force_x [N/m]\n0,much\n", "much"),
        ("x\n", "'time' is not a column; known: x"),
        ("time\n0\n1\n", "is not a column; known: time"),
        (None, "no such file"),
    ],
)
@pytest.mark.parametrize("name", ["all", "crest"])
def test_loads_names_the_file(run, name, text, said):
    file = run / "gauges" / f"{name}.csv"
    file.unlink() if text is None else file.write_text(text)
    done = called("loads", run)
    assert isinstance(done.exception, UserError), done.output
    for word in (str(file), said):
        assert word in str(done.exception)


@pytest.mark.parametrize("text", ["", None])
def test_plot_names_the_file(run, text):
    file = run / "gauges" / "all.csv"
    file.unlink() if text is None else file.write_text(text)
    done = called("plot", run)
    assert isinstance(done.exception, UserError), done.output
    assert str(file) in done.output


@pytest.mark.parametrize("text", ["", "x\n", "x [m],[y] [z [m]\n0,0\n"])
def test_a_report_names_what_it_leaves_out(run, text):
    """Of loads it leaves out nothing: there the file is named."""
    file = run / "gauges" / "top.csv"
    file.write_text(text)
    done = called("report", run)
    assert done.exit_code == 0, done.output
    assert f"gauge top is left out: {file}" in done.output.replace("\n", "")
    file = run / "gauges" / "sill.csv"
    file.write_text(text)
    done = called("report", run)
    assert isinstance(done.exception, UserError), done.output
    assert str(file) in str(done.exception)
