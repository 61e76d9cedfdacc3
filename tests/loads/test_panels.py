"""Panels: what is refused, and what their figures show."""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from doseki.errors import UserError
from doseki.figures.kinds.load import _draw_parts
from doseki.figures.kinds.registry import draw
from doseki.figures.nothing import NothingToDrawError
from doseki.measure.views import tables
from doseki.record.reader import GaugeRecord
from doseki.scenario.tables.figure import Figure
from doseki.scene.checks.panels import _bare_panel
from doseki.solver.build import build_simulation

from .scenes import DAM, DAM_3D, run_of, scenario_of

FACE = 'kind = "panels"\nbodies = ["dam"]\n'


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("origin = [0.38, 0]\nedges = [[0, 0.5]]\npanels = [5]\ndirection = [-1, 0]", "no surface"),
        ("origin = [0.4, 0]\nedges = [[0, 0.5]]\npanels = [5]\ndirection = [1, 0]", "no surface"),
        (
            "origin = [0.4, 0]\nedges = [[0, 0.9]]\npanels = [5]\ndirection = [-1, 0]",
            "reach beyond",
        ),
        (
            "origin = [0.4, 0]\nedges = [[0, 0.5]]\npanels = [500]\ndirection = [-1, 0]",
            "smaller than a particle",
        ),
        (
            "origin = [0.4, 0]\nedges = [[0, 0.5]]\npanels = [5]\ndirection = [0, 1]",
            "lies in the face",
        ),
        ("origin = [0.4, 0]\nedges = [[0, 0]]\npanels = [5]\ndirection = [-1, 0]", "no length"),
        (
            "origin = [0.4, 0]\nedges = [[0, 1], [1, 0]]\npanels = [5]\ndirection = [-1, 0]",
            "needs 1 here",
        ),
        ("origin = [0.4, 0]\nedges = [[0, 0.5]]\npanels = [0]\ndirection = [-1, 0]", "panels"),
        ("origin = [0.4, 0]\nedges = [[0, 0.5]]\npanels = [5]", "direction is missing"),
    ],
)
def test_wrong_tables_are_refused(tmp_path, table, said):
    text = f"{DAM}\n[gauge.bad]\n{FACE}{table}\n"
    with pytest.raises(UserError, match=said):
        build_simulation(scenario_of(tmp_path, text))


def build(tmp_path, fits, text, *overrides):
    """Build what fits; what does not is refused."""
    scenario = scenario_of(tmp_path, text, *overrides)
    with nullcontext() if fits else pytest.raises(UserError, match="reach beyond the face"):
        build_simulation(scenario)


@pytest.mark.parametrize("panels", [1, 4, 13])
@pytest.mark.parametrize(("beyond", "fits"), [(0.0, True), (0.9, True), (1.2, False), (3, False)])
def test_a_grid_reaches_beyond_its_face_by_a_spacing_at_most(tmp_path, panels, beyond, fits):
    """Whatever the size of a panel: what is missing is of whole particles."""
    length = 0.52 + beyond * 0.01
    face = f"origin = [0.4, 0]\nedges = [[0, {length}]]\ndirection = [-1, 0]\npanels = [{panels}]"
    build(tmp_path, fits, f"{DAM}\n[gauge.long]\n{FACE}{face}\n")


@pytest.mark.parametrize(("beyond", "fits"), [(0.8, True), (1.2, False)])
def test_a_grid_in_space_does_so_along_each_edge(tmp_path, beyond, fits):
    """The face is 8 spacings wide between its banks, and 10 high."""
    edges = f"gauge.face.edges=[[0, 0.4, 0], [0, 0, {0.5 + 0.05 * beyond}]]"
    build(tmp_path, fits, DAM_3D, edges, "particles=8", "gauge.face.panels=[3, 3]")


SLANT = """\
dim = 3
dp = 0.05
time_max = 0.1
time_out = 0.1
scheme = "resolved"
speed_max = 2
gravity = [0, 0, -9.8]
[body.dam]
shape = "mesh"
file = "dam.stl"
material = "aluminium"
[gauge.face]
kind = "panels"
bodies = ["dam"]
origin = [0, 0, 0]
edges = [[0, {long}, 0], [0.1, 0, 0.5]]
panels = [{count}, 5]
direction = [-0.5, 0, 0.1]
"""


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize(("beyond", "fits"), [(0.0, True), (0.9, True), (4, False)])
def test_long_panels_of_a_slant_may_lack_a_row_and_a_spacing_at_their_ends(
    tmp_path, count, beyond, fits
):
    """The two panels from top and foot of this face lack 8 % of a row that lies along them."""
    ends = [(x, y, z) for x, z in ((0, 0), (1.5, 0), (0.4, 0.5), (0.1, 0.5)) for y in (0, 3.0)]
    trimesh.convex.convex_hull(np.array(ends)).export(tmp_path / "dam.stl")
    build(tmp_path, fits, SLANT.format(long=3.0 + 0.05 * beyond, count=count))


@pytest.mark.parametrize(
    ("panels", "covered", "bare"),
    [
        ([3, 3], [[0.5, 1, 0.5], [1, 1, 1], [0.5, 1, 0.5]], None),
        ([3, 3], [[1, 1, 1], [0.5, 0.5, 0.5], [1, 1, 1]], None),  # a row that is not there
        ([3, 3], [[1, 1, 1], [0.5, 0.4, 0.5], [1, 1, 1]], 4),
        ([3, 3], [[1, 1, 0.9], [1, 1, 0.9], [1, 1, 0.9]], 2),  # nothing at an end of long panels
        ([3, 3], [[0.9, 0.9, 0.9]] * 3, None),  # all of the face is like that
        ([1, 4], [[1], [0.5], [0.5], [1]], None),
        ([1, 4], [[0.9], [0.5], [0.5], [0.9]], 0),
        ([2, 2], [[0.48, 0.95], [0.95, 0.95]], 0),
        ([2, 2], [[0.5, 0.95], [0.95, 0.95]], None),
    ],
)
def test_what_a_panel_of_two_spacings_by_twenty_may_lack(panels, covered, bare):
    face = SimpleNamespace(size=np.array([1.0, 0.1]), panels=panels)
    assert _bare_panel(face, np.ravel(covered), 0.05) == bare


def test_edges_are_at_right_angles(tmp_path):
    with pytest.raises(UserError, match="right angles"):
        scenario_of(tmp_path, DAM_3D, "gauge.face.edges=[[0, 0.4, 0], [0, 0.1, 0.4]]")


def test_bodies_that_move_have_no_panels(tmp_path):
    moving = "body.dam.motion={velocity=[1, 0]}"
    with pytest.raises(UserError, match=r'"dam" moves, the panels stand still'):
        scenario_of(tmp_path, DAM, moving)


def test_a_figure_of_something_else_is_refused(tmp_path):
    text = DAM + '[gauge.p]\nkind = "pressure"\nposition = [0.1, 0.1]\n'
    text += '[figure.f]\nkind = "load"\ngauge = "p"\n'
    with pytest.raises(UserError, match='is of kind "pressure", not "load" or "panels"'):
        scenario_of(tmp_path, text)


@pytest.fixture(scope="module")
def dam(tmp_path_factory):
    return run_of(tmp_path_factory.mktemp("dam"), DAM_3D, "time_max=0.06", "particles=8")


def test_a_map_shows_the_sample_in_which_the_flow_presses_most(dam):
    figure = draw(dam, "face", tables(dam, "figure", Figure)["face"])
    (mesh,) = figure.axes[0].collections
    pressure = dam.gauges["face"]["flow_pressure"].reshape(-1, 4, 2)[1:]
    peak = np.argmax(pressure.mean(axis=(1, 2)))
    np.testing.assert_allclose(np.asarray(mesh.get_array()).reshape(4, 2), pressure[peak])
    mean = figure.axes[1].lines[0]
    assert mean.get_label() == "mean"
    np.testing.assert_allclose(mean.get_ydata(), pressure.mean(axis=(1, 2)))


def test_a_figure_of_a_load_has_its_parts(dam):
    figure = draw(dam, "dam", tables(dam, "figure", Figure)["dam"])
    assert len(figure.axes) == 6
    names = [line.get_label() for line in figure.axes[0].lines]
    assert names == ["total", "static", "dynamic", "contact", "largest step"]
    record = dam.gauges["dam"]
    np.testing.assert_allclose(figure.axes[0].lines[1].get_ydata(), record["static_force_x"][1:])


@pytest.mark.parametrize("name", ["dam", "face"])
def test_where_nothing_acts_nothing_is_drawn(tmp_path, name):
    away = DAM_3D.replace('max = [0.6, "= width", "= depth"]', 'max = [0.3, "= width", "= depth"]')
    assert away != DAM_3D
    run = run_of(tmp_path, away, "time_max=0.06", "particles=8", "gravity=[0, 0, 0]")
    with pytest.raises(NothingToDrawError, match=f"nothing acted on what {name} reads"):
        draw(run, name, tables(run, "figure", Figure)[name])


def test_the_map_of_a_face_stands_above_its_curves(dam):
    """Its left side is theirs, and its scale of colours stands beside it."""
    figure = draw(dam, "face", tables(dam, "figure", Figure)["face"])
    figure.canvas.draw()
    face, below = (axes.get_window_extent() for axes in figure.axes[:2])
    assert face.x0 == pytest.approx(below.x0, abs=1)
    (scale,) = figure.axes[0].child_axes
    assert 0 < scale.get_window_extent().x0 - face.x1 < 0.1 * face.width


def test_curves_of_a_face_take_the_width_of_its_figure(dam):
    """Their legend stands above them, not beside all of it."""
    figure = draw(dam, "face", tables(dam, "figure", Figure)["face"])
    figure.canvas.draw()
    curves = figure.axes[1]
    assert curves.get_window_extent().width > 0.75 * figure.bbox.width
    names = [text.get_text() for text in curves.get_legend().get_texts()]
    assert names == ["mean", "highest panel"]
    assert not figure.legends
    assert curves.get_legend().get_window_extent().y0 >= curves.get_window_extent().y1 - 1


def load_record(across, along, contact):
    """A load with forces of these sizes along x and y, of which contacts are a factor apart."""
    time = np.linspace(0, 1, 11)
    parts = ("", "static_", "dynamic_", "contact_", "peak_")
    columns = {"time": time, "peak_time": time}
    for k, axis in enumerate("xy"):
        size = (across, along)[k]
        columns |= {f"{part}force_{axis}": size * (2 + np.sin(9 * time)) for part in parts}
        columns[f"contact_force_{axis}"] *= contact
    columns |= {f"{part}moment": np.sin(9 * time) for part in parts}
    rows = [[repr(float(x)) for x in row] for row in zip(*columns.values(), strict=True)]
    return GaugeRecord([f"{name} [N]" for name in columns], rows, "dam.csv")


def limits_of_parts(across, along):
    """Limits of the panels of such a load."""
    record = load_record(across, along, 1.0)
    return [axes.get_ylim() for axes in _draw_parts(record, 2, "dam").axes]


@pytest.mark.parametrize(("contact", "apart"), [(0.0, False), (2.0, False), (200.0, True)])
def test_contacts_squash_nothing_that_the_flow_gives(contact, apart):
    """Where they are large, they stand beside it, in the same colours and at the same times."""
    record = load_record(1.0, 2.0, contact)
    axes = _draw_parts(record, 2, "dam").axes
    if not apart:
        assert len(axes) == 3
        return
    flow, both = axes[::2], axes[1::2]
    assert [each.get_title(loc="left") for each in axes[:2]] == ["flow", "flow and contacts"]
    assert [line.get_label() for line in flow[0].lines] == ["static", "dynamic"]
    assert [line.get_label() for line in both[0].lines] == ["total", "contact", "largest step"]
    assert [line.get_color() for line in (*both[0].lines[:2], *flow[0].lines)] == [
        "C0", "C3", "C1", "C2",
    ]  # fmt: skip
    largest = np.abs(record["static_force_y"]).max()
    assert largest <= flow[1].get_ylim()[1] < 1.2 * largest
    assert both[1].get_ylim()[1] > 100 * largest


@pytest.mark.parametrize(("flow", "columns"), [(0.0, 1), (1e-12, 1), (1e-3, 2)])
def test_contacts_of_a_dry_load_stand_alone(flow, columns):
    """What rounding gives of a flow that is not there is no column of its own."""
    record = load_record(flow, flow, 1.0)
    for name in record.units:
        if name.startswith(("static_moment", "dynamic_moment")):
            record[name][:] *= flow
        elif name.startswith("contact_"):
            record[name][:] = 1e3
    figure = _draw_parts(record, 2, "dam")
    assert len(figure.axes) == 3 * columns


@pytest.mark.parametrize("along", [1e3, 1e-3])
@pytest.mark.parametrize("share", [0.0, 1e-13, 1e-3])
def test_what_is_rounding_has_the_scale_of_the_others(share, along):
    x, y, moment = limits_of_parts(share * along, along)
    if share < 1e-9:
        assert x == (0, y[1])
    else:
        assert x[1] < 0.1 * y[1]
    assert max(moment) < 2
