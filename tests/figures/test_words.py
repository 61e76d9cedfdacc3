"""Titles are drawn as they are written, and no figure loses a finished run."""

from __future__ import annotations

import io
import json
import shutil

import numpy as np
import pytest

from doseki.cli.main import main
from doseki.errors import UserError
from doseki.figures import plot, saving, text
from doseki.figures.census_output import CensusOptions, write_census
from doseki.figures.dots import extent_of
from doseki.figures.layout import PanelGrid, ViewRows, chart_grid, nice_length, time_text
from doseki.figures.movie import _Camera
from doseki.figures.stage import WIDTH
from doseki.measure.views import whole_space
from doseki.record.history import history_columns
from doseki.record.reader import load
from doseki.running.progress import progress_bar
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.studies import compare

from ..synthetic_runs import flow_state

RUN = """\
dim = 2
dp = 0.05
time_max = 0.002
time_out = 0.001
xi = 0.05
[body.block]
shape = "box"
material = "water"
min = [0, 0]
max = [0.2, 0.2]
[gauge.level]
kind = "surface_height"
position = [0.1, 0]
"""
NAMES = ["flow", "overview"]  # of general figures of a closed run, but for the energy
ODD = ("5 $ and 7 $", "$\\frac{1}{", "[/] [bold]", "\\alpha \\$ %s {x} ^_", "土石流 debris")


@pytest.fixture
def scenario(tmp_path):
    """Writes a small scenario with more tables."""

    def write(more="", title="plain"):
        file = tmp_path / "case.toml"
        file.write_text(f"title = {json.dumps(title)}\n{RUN}{more}", encoding="utf-8")
        return file

    return write


def picture(title):
    """The pixels of a chart with a title."""
    figure, _ = chart_grid(1, 1, (3, 1), title)
    image = io.BytesIO()
    figure.savefig(image, format="rgba")
    return np.frombuffer(image.getvalue(), np.uint8)


def test_dollars_begin_no_formula():
    with text.plain_text() as missing:
        one, other = picture("a $x$ b"), picture("a x b")
        assert not np.array_equal(one, other)
        assert np.array_equal(one, picture("a $x$ b"))
    with_formula = picture("a $x$ b")
    assert not np.array_equal(one, with_formula)
    assert missing == []


def test_characters_without_a_font_are_told(monkeypatch):
    monkeypatch.setattr(text, "CJK", ())
    with text.plain_text() as missing:
        picture("土石 debris")
    (said,) = text.missing_text(missing)
    assert "no font has the characters 土石" in said
    assert "fonts-noto-cjk" in said


def test_characters_of_many_pictures_are_told_once(monkeypatch, tmp_path, recwarn):
    monkeypatch.setattr(text, "CJK", ())
    drawn = saving.Drawn()
    for name, title in (("one", "土石"), ("two", "石流"), ("three", "plain")):
        drawn.add(tmp_path / f"{name}.png", lambda t=title: chart_grid(1, 1, (3, 1), t)[0])
    assert len(drawn.pictures) == 3
    (said,) = drawn.remarks
    assert "the characters 土石流:" in said
    assert not recwarn.list


LONG = "土石流" + "Supercalifragilistic_" * 8 + " and more of a torrent" * 5


@pytest.mark.parametrize(
    "make",
    [
        lambda: chart_grid(1, 1, (3, 1), LONG)[0],
        lambda: PanelGrid(2, [True], (0.0, 1.0, 0.0, 3.0), LONG).figure,
        lambda: ViewRows(1, [(0.0, 1.0, 0.0, 1.0)] * 3, LONG).figure,
    ],
)
def test_long_titles_are_drawn_in_full_above_the_panels(make):
    with text.plain_text():
        figure = make()
        canvas = figure.canvas
        canvas.draw()
        title = figure._suptitle
        box, whole = title.get_window_extent(), figure.bbox
    assert title.get_text().replace("\n", "").replace(" ", "") == LONG.replace(" ", "")
    assert whole.x0 <= box.x0 < box.x1 <= whole.x1
    assert box.y1 <= whole.y1
    for axes in figure.axes:
        assert axes.get_window_extent().y1 < box.y0


def test_the_title_of_a_grid_keeps_clear_of_its_panels():
    with text.plain_text():
        grid = PanelGrid(1, [False], (0.0, 1.0, 0.0, 3.0), LONG)
        axes = grid.panel(0, 0)
        axes.set_title("t = 0.00 s")
        grid.figure.canvas.draw()
        assert axes.title.get_window_extent().y1 < grid.figure._suptitle.get_window_extent().y0


@pytest.mark.parametrize(
    ("time", "longest", "said"),
    [
        (0.5, 2.0, "t = 0.50 s"),
        (1.46e-3, 1.59e-3, "t = 0.00146 s"),
        (0, 0.04, "t = 0.0000 s"),
        (0, 0, "t = 0.00 s"),
    ],
)
def test_times_are_in_seconds_as_at_the_axes_of_curves(time, longest, said):
    assert time_text(time, longest) == said


@pytest.mark.parametrize("title", ODD)
def test_odd_titles_are_drawn(scenario, tmp_path, capsys, title):
    figure = f'[figure.one]\nkind = "series"\ncolumns = ["mass"]\ntitle = {json.dumps(title)}\n'
    with pytest.raises(SystemExit) as ended:
        main(["run", str(scenario(figure, title)), "-o", str(tmp_path / "run"), "--threads", "1"])
    assert ended.value.code == 0
    said = capsys.readouterr()
    assert said.out.startswith(title)
    assert "status            done" in said.out
    assert "could not be drawn" not in said.err
    assert (tmp_path / "run/figures/one.png").is_file()
    assert (tmp_path / "run/figures/overview.png").is_file()


@pytest.mark.parametrize("title", ODD)
def test_odd_titles_are_no_markup_of_the_progress_bar(monkeypatch, title):
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress_bar(title, 1.0) as progress:
        progress(0.5, 1e-3, 10)


@pytest.mark.parametrize(
    ("figure", "said"),
    [
        ('kind = "snapshot"\ncolour = []', "colour"),
        ('kind = "snapshot"\ncolour = [""]', "colour"),
        ('kind = "snapshot"\ntimes = [' + "0.1, " * 100 + "]", "times"),
        ('kind = "snapshot"\ntimes = [0, -1]', r"figure.one.times.1 = -1 is out of range; must be"),
        (
            'kind = "gauge"\ngauge = "level"\ntimes = [-1]',
            "figure.one.times.0 = -1 is out of range",
        ),
        ('kind = "histogram"\nbin_width = 1e-300', "bin_width"),
        ('kind = "histogram"\nbin_width = 1e-9', "more than 2000 bins"),
        ('kind = "histogram"\nbin_width = 1e300', "bin_width"),
        ('kind = "histogram"\nsample = 100000000000', "sample"),
        ('kind = "series"\ncolumns = []', "columns"),
        ('kind = "series"\ncolumns = ["n_watr"]', '"n_watr" is not a column.*did you mean n_water'),
        ('kind = "series"', "columns is missing"),
        ('kind = "gauge"\ngauge = "level"\ncolumns = ["hight"]', "did you mean height"),
        ('kind = "series"\ncolumns = ["mass"]\ntitle = "a\\nb"', "one line"),
        ('kind = "series"\ncolumns = ["mass"]\ntitle = "\\u001b[2J"', "one line"),
        ('kind = "series"\ncolumns = ["mass"]\ntitle = "' + "x" * 400 + '"', "title"),
    ],
)
def test_figures_that_cannot_be_drawn_are_refused_before_the_run(scenario, figure, said):
    with pytest.raises(UserError, match=said):
        load_scenario(scenario(f"[figure.one]\n{figure}\n"))


def test_the_columns_that_figures_may_name_are_those_of_the_record(scenario, tmp_path):
    case = load_scenario(scenario())
    run_scenario(case, tmp_path / "run", RunOptions(threads=1))
    columns = load(tmp_path / "run").history.columns
    assert columns == history_columns(2, case.material_names)


def test_a_figure_that_fails_loses_neither_the_others_nor_the_summary(
    scenario, tmp_path, capsys, monkeypatch
):
    def fail(_run):
        raise RuntimeError("out of\nink")

    monkeypatch.setitem(plot.GENERAL, "energy", fail)
    with pytest.raises(SystemExit) as ended:
        main(["run", str(scenario()), "-o", str(tmp_path / "run"), "--threads", "1"])
    assert ended.value.code == 0
    said = capsys.readouterr()
    assert "warning: figure energy could not be drawn: RuntimeError('out of" in said.err
    assert "status            done" in said.out
    assert (tmp_path / "run/summary.txt").read_text().startswith("plain")
    assert sorted(f.stem for f in (tmp_path / "run/figures").iterdir()) == NAMES
    with pytest.raises(SystemExit) as ended:
        main(["plot", str(tmp_path / "run")])
    assert ended.value.code == 2
    assert "1 of the figures could not be drawn" in capsys.readouterr().err


BREAKABLE = ["doseki.assess.summary.summary_text", "doseki.running.runner.load"]


@pytest.mark.parametrize("broken", BREAKABLE)
def test_a_summary_that_fails_loses_no_run(scenario, tmp_path, capsys, monkeypatch, broken):
    def fail(_run):
        raise RuntimeError("no words")

    monkeypatch.setattr(broken, fail)
    with pytest.raises(SystemExit) as ended:
        main(
            ["run", str(scenario()), "-o", str(tmp_path / "run"), "--threads", "1", "--no-figures"]
        )
    assert ended.value.code == 0
    said = capsys.readouterr()
    assert "no words" in said.err + said.out
    assert "status            done" in said.out


def test_a_disk_that_is_full_for_pictures_loses_no_run(scenario, tmp_path, capsys, monkeypatch):
    def fail(*_arguments):
        raise OSError(28, "No space left on device")

    shutil.rmtree(tmp_path / "run", ignore_errors=True)
    monkeypatch.setattr(saving, "write_whole", fail)
    with pytest.raises(SystemExit) as ended:
        main(["run", str(scenario()), "-o", str(tmp_path / "run"), "--threads", "1"])
    assert ended.value.code == 0
    said = capsys.readouterr()
    assert "No space left" in said.err
    assert "status            done" in said.out


@pytest.mark.parametrize(("error", "code"), [(OSError(28, "No space left"), 4), (ValueError(), 2)])
def test_plot_tells_a_full_disk_from_other_failures(flow_folder, monkeypatch, error, code):
    def fail(*_arguments, **_options):
        raise error

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fail)
    with pytest.raises(SystemExit) as ended:
        main(["plot", str(flow_folder)])
    assert ended.value.code == code


def test_movies_have_axes_a_scale_bar_and_their_title(scenario, tmp_path):
    file = scenario(title="5 $ and 7 $")
    run_scenario(load_scenario(str(file)), tmp_path / "run", RunOptions(threads=1))
    run = load(tmp_path / "run")
    with text.plain_text():
        camera = _Camera(run, "speed", None)
        frame = next(iter(camera.frames()))
    figure = camera.stage.figure
    (axes,) = figure.axes
    assert (*axes.get_xlim(), *axes.get_ylim()) == pytest.approx(extent_of([*run], whole_space(2)))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (m)", "y (m)")
    assert len(axes.get_xticks()) > 2
    words = [each.get_text() for each in figure.texts]
    assert words == ["5 $ and 7 $", "0.02 m"]
    assert not any(each.get_parse_math() for each in figure.texts)
    (bar,) = [line for line in figure.artists if line.get_gid() == "scale bar"]
    pixels = np.ptp(bar.get_xdata()) * frame.width
    assert pixels * np.ptp(axes.get_xlim()) / WIDTH == pytest.approx(0.02, rel=1e-6)
    assert len(figure.legends) == 1


@pytest.mark.parametrize(
    ("longest", "length"), [(1.0, 1), (0.99, 0.5), (0.3, 0.2), (4.9, 2), (5.0, 5), (37.0, 20)]
)
def test_scale_bars_have_round_lengths(longest, length):
    assert nice_length(longest) == pytest.approx(length)


def test_a_census_is_drawn_in_plain_text(tmp_path, record_run, monkeypatch):
    monkeypatch.setattr(text, "CJK", ())
    tables = '\n[window."土石"]\nmin = [-9.0, -9.0]\nmax = [9.0, 9.0]\n'
    record_run(tmp_path / "run", state_at=flow_state, tables=tables)
    lines = write_census(tmp_path / "run", CensusOptions(window="土石"))
    assert "no font has the characters 土石" in lines[-1]


def test_a_comparison_is_drawn_in_plain_text(tmp_path, monkeypatch):
    def drawn(_flumes):
        figure, _ = chart_grid(1, 1, (3, 1), "5 $ and \\frac{1")
        assert not figure._suptitle.get_parse_math()
        return figure

    monkeypatch.setattr(compare, "_water_figure", drawn)
    monkeypatch.setattr(compare, "_passed_figure", drawn)
    compare._draw_pictures((), tmp_path)
    assert (tmp_path / "water.png").is_file()
