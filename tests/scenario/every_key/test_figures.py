"""Every key of figures and windows changes a picture or is refused: see walk.py."""

from __future__ import annotations

import hashlib

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from doseki.errors import UserError
from doseki.figures.kinds import spatial
from doseki.figures.kinds.registry import draw
from doseki.figures.nothing import NothingToDrawError
from doseki.measure.views import tables
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.load import load_scenario
from doseki.scenario.tables.figure import FIGURES
from doseki.scenario.tables.figure import Figure as FigureTable
from doseki.scenario.tables.region import Window

from .walk import BLOCK, NONE, REFUSED, ignored, replaced, text_of

DOTS = 30  # per inch: a picture is looked at by its digest alone
NOT_DRAWN = {"kind", "enabled"}
SCENE = """
[gauge.column]
kind = "velocity_profile"
position = [0.3, @00]
length = 0.4
interval = 0.01
[gauge.level]
kind = "surface_height"
position = [0.3, @00]
interval = 0.01
[window.all]
min = [-0.2, @--0.3]
max = [1.4, @11]
[window.part]
min = [0.1, @-0.05]
max = [0.5, @11]
"""
RESOLVED = """
[gauge.floor]
kind = "load"
bodies = ["floor"]
interval = 0.01
[gauge.bent]
kind = "load"
bodies = ["floor"]
about = [1, @01]
interval = 0.01
[figure.load]
kind = "load"
gauge = "floor"
"""  # what only that scheme has
FIGURE = {
    "snapshot": 'window = "all"\n',
    "histogram": 'window = "all"\nmaterial = "water"\n',
    "series": 'columns = ["kinetic_energy"]\n',
    "gauge": 'gauge = "column"\n',
    "xt": "start = [0.0, @00]\nend = [0.6, @00]\ncount = 10\n",
}
KEYS = {
    "title": ["seen from the side"],
    "window": ["part"],
    "times": ["[0.0]"],
    "when": ["first", "all", "events", "before_flow"],
    "material": ["rock"],
    "colour": ["['speed']", "['pressure', 'velocity_x']"],
    "bin_width": ["0.05"],
    "sample": ["7"],
    "columns": ["['bulk_energy']", "['pressure_energy']", "['velocity_x']", "['height']"],
    "gauge": ["level", "bent"],
    "start": ["[0.2, {zeros}0]"],
    "end": ["[0.5, {zeros}0]"],
    "direction": ["[0.3, {zeros}1]"],
    "count": ["7"],
}
WINDOW = {
    "title": ["near the wall"],
    "min": ["[0, {zeros}0]"],
    "max": ["[0.6, {ones}0.6]"],
    "rotate": ["10"],
}
cases = pytest.mark.parametrize(("scheme", "dim"), [("ueta2022", 2), ("resolved", 3)])


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """The scenario file and the folder of a short run of each case."""
    made = {}

    def record_of(scheme, dim):
        if (scheme, dim) not in made:
            base = tmp_path_factory.mktemp(scheme)
            figures = "".join(
                f'[figure.{kind}]\nkind = "{kind}"\n{keys}' for kind, keys in FIGURE.items()
            )
            more = RESOLVED if scheme == "resolved" else ""
            text = text_of(scheme, dim, BLOCK + SCENE + figures + more)
            text = text.replace("time_max = 1", "time_max = 0.03").replace(
                "= 0.1\ngr", "= 0.01\ngr"
            )
            (base / "case.toml").write_text(text)
            run_scenario(load_scenario(base / "case.toml"), base / "run")
            made[scheme, dim] = base / "case.toml", base / "run"
        return made[scheme, dim]

    return record_of


def pictures_of(folder):
    """What the pictures of a run show, by the name of a figure, as a digest."""

    def picture(path, settings, name):
        try:
            scenario = load_scenario(path, settings)
            (folder / "scenario.toml").write_text(scenario.effective_toml(stored=True))
            run = load(folder)
            table = tables(run, "figure", FigureTable).get(name)
            if table is None:
                return "not drawn"
            figure = draw(run, name, table)
        except UserError:
            return REFUSED
        except NothingToDrawError as reason:
            return str(reason)
        figure.set_dpi(DOTS)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        return hashlib.sha256(canvas.buffer_rgba()).hexdigest()

    return picture


def words(dim):
    return {"zeros": "0, " if dim == 3 else "", "ones": "0.2, " if dim == 3 else ""}


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Pictures of space with few pixels: it is not their beauty that is looked at."""
    monkeypatch.setattr(spatial, "PIXELS", 100)


@cases
@pytest.mark.parametrize("kind", FIGURES.tables)
def test_figures(record, kind, scheme, dim):
    if kind == "load" and scheme != "resolved":
        pytest.skip("no such gauge in this scheme")
    path, folder = record(scheme, dim)
    picture = pictures_of(folder)

    def outcome(path, settings):
        return picture(path, settings, kind)

    values = {key: [replaced(v, words(dim)) for v in entries] for key, entries in KEYS.items()}
    keys = sorted(set(FIGURES.tables[kind].model_fields) - NOT_DRAWN)
    assert outcome(str(path), ()) not in (REFUSED, "not drawn")
    assert outcome(str(path), (f"figure.{kind}.enabled=false",)) == "not drawn"
    assert ignored(str(path), f"figure.{kind}.", keys, values, outcome) == NONE


@cases
def test_windows(record, scheme, dim):
    path, folder = record(scheme, dim)
    picture = pictures_of(folder)

    def outcome(path, settings):
        seen = [picture(path, settings, name) for name in ("snapshot", "histogram")]
        return REFUSED if REFUSED in seen else "".join(seen)

    values = {key: [replaced(v, words(dim)) for v in entries] for key, entries in WINDOW.items()}
    keys = sorted(set(Window.model_fields) - NOT_DRAWN)
    assert ignored(str(path), "window.all.", keys, values, outcome) == NONE
    # A window that is off is one that its figures ask for in vain.
    assert outcome(str(path), ("window.all.enabled=false",)) == REFUSED
