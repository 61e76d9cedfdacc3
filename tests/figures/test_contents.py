"""What figures show: where the flow is, when something happens, nothing empty, one legend each."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from doseki.cli.main import main
from doseki.figures.dots import extent_of
from doseki.figures.kinds.energy import draw_energy, potential_energy
from doseki.figures.kinds.histogram import draw_speed_row
from doseki.figures.kinds.series import draw_curves
from doseki.figures.kinds.spatial import DOWN, Space
from doseki.figures.layout import chart_grid, name_of_curves, nice_length, say_where_empty
from doseki.figures.plot import draw_run, figures
from doseki.measure.census.census import draw_speeds
from doseki.measure.moments import moments
from doseki.measure.views import named_window, whole_space
from doseki.record.reader import load
from doseki.record.writer import Recorder

from ..synthetic_runs import (
    BODIES,
    FLOW_TABLES,
    MATERIALS,
    SCENARIO,
    flow_state,
    history_row,
    make_plain_state,
)

NEVER = """
[window.never]
min = [50.0, -0.1]
max = [60.0, 0.3]

[figure.never]
kind = "snapshot"
window = "never"
when = "with_flow"

[figure.before_never]
kind = "snapshot"
window = "never"
when = "before_flow"

[figure.speeds_there]
kind = "histogram"
window = "never"

[figure.all]
kind = "snapshot"
when = "events"
colour = ["material", "velocity_x"]
"""


def legends(figure):
    """Every legend of a figure: its own, and those of its panels."""
    return [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend())]


def with_walls_and_drops(drops):
    """Water in a unit square, walls 20 m long and high on its lower and left side, and drops."""
    water = np.random.default_rng(0).uniform(size=(4000, 2))
    along = np.arange(0.0, 20.0, 0.1)
    floor = np.stack([along, np.full(len(along), -0.05)], axis=1)
    wall = np.stack([np.full(len(along), -0.05), along], axis=1)
    stray = np.random.default_rng(1).uniform(5.0, 15.0, size=(drops, 2))
    position = np.concatenate([water, stray, floor, wall])
    kind = np.repeat([0, 2], [4000 + drops, 2 * len(along)])
    return make_plain_state(position, np.zeros_like(position), kind)


@pytest.mark.parametrize("drops", [0, 15])
def test_axes_hold_what_moves_and_walls_near_it(tmp_path, record_run, drops):
    record_run(
        tmp_path / "run", times=(0.0, 1.0), state_at=lambda _time: with_walls_and_drops(drops)
    )
    run = load(tmp_path / "run")
    left, right, bottom, top = extent_of([run[0], run[1]], whole_space(2))
    assert -0.3 < left < -0.05
    assert -0.3 < bottom < -0.05
    assert 1.0 < right < 1.3
    assert 1.0 < top < 1.3
    overview = dict(figures(run))["overview"]
    titles = [axes.get_title(loc="left") for axes in overview.axes]
    told = f"({drops} of {4000 + drops} particles are outside)"
    assert all((told in title) == (drops > 0) for title in titles)


def test_what_comes_late_and_is_little_is_held_too(tmp_path, record_run):
    """Each moment counts by itself: the flow is elsewhere in the last of ten."""

    def state(time):
        x = np.random.default_rng(0).uniform(size=(200, 2))
        x[:, 0] += 100.0 * (time == 9.0)
        return make_plain_state(x, np.zeros_like(x), np.zeros(200, int))

    record_run(tmp_path / "run", times=tuple(map(float, range(10))), state_at=state)
    extent = extent_of(list(load(tmp_path / "run")), whole_space(2))
    assert extent[0] < 0.1
    assert extent[1] > 100.9


@pytest.fixture
def flow_with_nothing(tmp_path, record_run):
    times = tuple(np.arange(0.0, 3.01, 0.25))
    record_run(tmp_path / "run", times=times, state_at=flow_state, tables=FLOW_TABLES + NEVER)
    return tmp_path / "run"


def test_what_would_be_empty_is_not_drawn_and_said(flow_with_nothing):
    drawn = draw_run(flow_with_nothing)
    assert drawn.failures == []
    assert {path.stem for path in drawn.pictures} == {
        "overview", "energy", "mass", "flow", "before", "energies", "all",
    }  # fmt: skip
    assert drawn.notes == [
        "figure speeds is not drawn: no basalt is in the window end then",  # the grains have left
        "figure never is not drawn: no fluid is in the window never then",
        "figure before_never is not drawn: no particle is in the window never ever",
        "figure speeds_there is not drawn: no particle is in the window never then",
    ]
    labels = [
        text.get_text() for text in dict(figures(load(flow_with_nothing)))["flow"].legends[0].texts
    ]
    assert labels == ["end"]  # the other window has no curve


def test_the_command_says_what_is_not_drawn(flow_folder, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["plot", str(flow_folder)])
    assert ended.value.code == 0
    assert "figure speeds is not drawn: no basalt is in the window end" in capsys.readouterr().out


def test_a_window_is_shown_before_something_comes(flow_with_nothing):
    """The figure `before` of the window that is reached later, empty or not."""
    assert "before" in dict(figures(load(flow_with_nothing)))


def test_every_figure_has_one_legend_at_most(flow_with_nothing):
    for name, figure in figures(load(flow_with_nothing)):
        assert len(legends(figure)) <= 1, name
    found = dict(figures(load(flow_with_nothing)))["all"]
    # One key for the materials, one bar for the velocity, however many moments.
    assert len(legends(found)) == 1
    assert sum(axes.get_ylabel() == "velocity x (m/s)" for axes in found.axes) == 1
    assert len(found.axes) > 4


def words_of(axes):
    return [text.get_text() for text in axes.texts]


def labels_of(axis):
    return [label.get_text() for label in axis.get_ticklabels() if label.get_visible()]


def test_a_panel_without_data_says_so_and_has_no_numbers():
    figure, grid = chart_grid(2, 1, (5.0, 1.4), "a gauge")
    times = np.array([0.0, 3.0])
    for axes, values in zip(grid[:, 0], ([np.nan, np.nan], [1.0, 2.0]), strict=True):
        draw_curves(axes, times, {"": np.array(values)})
        name_of_curves(axes, "contact force of all the stones x (N/m)", 1.4)
        say_where_empty(axes, times)
    figure.canvas.draw()
    empty, full = grid[:, 0]
    assert (words_of(empty), words_of(full)) == (["no data"], [])
    assert (labels_of(empty.yaxis), bool(labels_of(full.yaxis))) == ([], True)
    assert empty.get_xlim()[0] > -1.0
    above, below = (axes.yaxis.label.get_window_extent() for axes in (empty, full))
    assert above.y0 > below.y1


def test_speeds_of_nothing_are_no_measurement():
    row = Figure().subplots(1, 2)
    draw_speed_row(row, draw_speeds(np.zeros(0)), "grains")
    for axes in row:
        assert words_of(axes) == ["nothing came by"]
        assert labels_of(axes.yaxis) == labels_of(axes.xaxis) == []
        assert not axes.get_title(loc="left")


def recorded(folder, row_at):
    """A run of flow_state with a history of its own."""
    recorder = Recorder(folder, SCENARIO.format(dim=2, zeros=""), MATERIALS, BODIES, 2)
    for time in (0.0, 1.0, 2.0):
        recorder.snapshot(flow_state(time), time=time, step=0, dt=0.1)
        recorder.history(row_at(time))
    return folder


def test_a_ledger_of_mass_that_stays_is_not_drawn(tmp_path):
    def closed(time):
        return history_row(time) | {"mass_asked": 0.0, "mass_entered": 0.0, "mass_left": 0.0}

    drawn = draw_run(recorded(tmp_path / "closed", closed))
    assert "mass" not in {path.stem for path in drawn.pictures}
    assert "figure mass is not drawn: no mass enters or leaves" in drawn.notes
    assert "mass" in {
        path.stem for path in draw_run(recorded(tmp_path / "open", history_row)).pictures
    }


def test_energy_has_the_potential_energy_and_the_total(tmp_path):
    """Two stones fall: what they gain in speed they lose in height."""
    g, times = 9.0, np.linspace(0.0, 1.0, 11)
    recorder = Recorder(
        tmp_path / "run", SCENARIO.format(dim=2, zeros=""), ["a", "b", "c"], ["d"] * 3, 2
    )
    zero = dict.fromkeys(("bulk_energy", "shear_energy", "av_dissipation"), 0.0)
    zero |= {"mass_entered": 0.0, "mass_left": 0.0}
    for t in times:
        # Gravity is (-1, -9): they fall along both axes.
        moved = -0.5 * np.array([1.0, g]) * t**2
        position = np.array([[0.0, 10.0], [1.0, 20.0], [-50.0, -50.0]]) + moved * [[1], [1], [0]]
        velocity = np.array([[-1.0, -g]] * 2 + [[0.0, 0.0]]) * t
        recorder.snapshot(
            make_plain_state(position, velocity, np.array([0, 1, 2])), time=t, step=0, dt=0.1
        )
        recorder.history(history_row(t) | zero | {"kinetic_energy": (1 + g**2) * t**2})
    run = load(tmp_path / "run")
    fallen = potential_energy(run)[0] - potential_energy(run)
    np.testing.assert_allclose(fallen, (1 + g**2) * times**2, atol=1e-9)
    figure = draw_energy(run)
    curves = {line.get_label(): line for line in figure.axes[0].lines}
    assert list(curves) == ["kinetic energy", "potential energy", "total"]
    total = curves["total"].get_ydata()
    np.testing.assert_allclose(total, total[0])
    # The fixed one does not count, however low it lies.
    assert potential_energy(run).max() < 600


@pytest.mark.parametrize("scheme", ["resolved", "ueta2022"])
def test_the_total_of_energy_is_a_balance_or_not_there(tmp_path, scheme):
    """Water that falls, and of which a part leaves: only the account knows what that took along."""
    text = SCENARIO.format(dim=2, zeros="").replace("dim = 2", f'dim = 2\nscheme = "{scheme}"')
    recorder = Recorder(tmp_path / "run", text, MATERIALS, BODIES, 2)
    for time in (0.0, 1.0, 2.0):
        recorder.snapshot(flow_state(time), time=time, step=0, dt=0.1)
        recorder.history(
            history_row(time)
            | dict.fromkeys(("bulk_energy", "shear_energy", "elastic_energy"), 0.0)
            | dict.fromkeys(("fracture_work", "parting_work", "damping_work"), 0.0)
            | {"kinetic_energy": 5 * time, "gravity_work": 12 * time, "energy_left": 4 * time}
            | {"av_dissipation": 6 * time, "wall_work": time, "contact_work": 0.0}
            | {"scheme_work": 0.0, "energy_entered": 2 * time, "mass_left": time}
        )
    lines = {line.get_label(): line for line in draw_energy(load(tmp_path / "run")).axes[0].lines}
    assert ("total" in lines) == (scheme == "resolved")
    if scheme == "resolved":
        total = lines["total"].get_ydata()
        np.testing.assert_allclose(total, total[0])
        np.testing.assert_allclose(lines["less wall work"].get_ydata(), [0, -1, -2])


def wave(time):
    """Water whose front goes from 1 m to 9 m in 4 s and stays; it is fastest at 3 s."""
    front = min(1.0 + 2.0 * time, 9.0)
    x = np.linspace(0.0, front, 200)
    speed = 3.0 - abs(time - 3.0) / 2
    position = np.stack([x, np.zeros(200)], axis=1)
    return make_plain_state(position, np.full((200, 2), [speed, 0.0]), np.zeros(200, int))


@pytest.fixture
def wave_run(tmp_path, record_run):
    tables = "[window.far]\nmin = [5.5, -1.0]\nmax = [8.0, 1.0]\n"
    times = tuple(np.arange(0.0, 8.01, 0.5))
    record_run(tmp_path / "run", times=times, state_at=wave, tables=tables)
    file = tmp_path / "run/scenario.toml"
    file.write_text(file.read_text().replace("gravity = [-1.0, ", "gravity = [0.0, "))
    return load(tmp_path / "run")


def test_times_are_those_at_which_something_happened(wave_run):
    found = [(wave_run.times[m.index], m.name) for m in moments(wave_run, whole_space(2))]
    assert found == [(0, "start"), (3.0, "peak"), (4.0, "arrival"), (8.0, "end")]
    titles = [axes.get_title(loc="left") for axes in dict(figures(wave_run))["overview"].axes]
    assert titles == [
        "t = 0.00 s, start", "t = 3.00 s, peak", "t = 4.00 s, arrival", "t = 8.00 s, end",
    ]  # fmt: skip


def test_in_a_window_the_flow_arrives_when_it_is_seen_there(wave_run):
    found = moments(wave_run, named_window(wave_run, "far"))
    assert (wave_run.times[found[1].index], found[1].name) == (2.5, "arrival")


def test_bodies_that_meet_are_shown_when_they_are_slowest(tmp_path, record_run):
    def state(time):
        speed = abs(time - 1.0) + 0.1
        position = np.array([[-1.0 - time, 0.0], [1.0 + time, 0.0]])
        return make_plain_state(position, np.array([[speed, 0], [-speed, 0]]), np.array([1, 1]))

    record_run(tmp_path / "run", times=(0.0, 0.5, 1.0, 1.5, 1.9), state_at=state)
    run = load(tmp_path / "run")
    names = {m.name: run.times[m.index] for m in moments(run, whole_space(2))}
    assert names["least kinetic energy"] == 1.0


@pytest.fixture
def pillar(tmp_path, record_run):
    """Water in a tank with walls on all sides, a pillar and a round grain in it."""

    def state(_time):
        cells = [np.arange(n) * 0.1 + 0.05 for n in (12, 8, 8)]
        x, y, z = (a.ravel() - 0.2 for a in np.meshgrid(*cells, indexing="ij"))
        box = np.stack([x, y, z], axis=1)
        inner = ((box > 0) & (box < [0.8, 0.4, 0.9])).all(axis=1)
        column = (abs(box[:, :2] - [0.6, 0.2]) < 0.1).all(axis=1) & inner
        water = inner & ~column & (box[:, 2] < 0.3)
        wall = ~inner
        position = np.concatenate([box[water], [[0.2, 0.2, 0.5]], box[column], box[wall]])
        kind = np.repeat([0, 1, 2, 2], [water.sum(), 1, column.sum(), wall.sum()])
        return make_plain_state(position, np.zeros_like(position), kind)

    record_run(tmp_path / "run", dim=3, times=(0.0, 1.0), state_at=state)
    return load(tmp_path / "run")


def test_runs_in_space_have_three_views_beside_each_other(pillar):
    figure = dict(figures(pillar))["overview"]
    assert len(legends(figure)) == 1
    slanting, plan, section = figure.axes[:3]
    assert len(figure.axes) == 6  # start and end
    assert [axes.get_title(loc="left") for axes in (plan, section)] == ["plan", "long section"]
    assert (plan.get_xlabel(), plan.get_ylabel()) == ("x' (m)", "y (m)")
    assert (section.get_xlabel(), section.get_ylabel()) == ("x' (m)", "z' (m)")
    for axes in (slanting, plan):
        assert any(isinstance(artist, AxesImage) for artist in axes.get_children())
    boxes = [axes.get_position() for axes in (slanting, plan, section)]
    assert boxes[0].x1 < boxes[1].x0 < boxes[1].x1 < boxes[2].x0
    assert boxes[1].y1 == pytest.approx(boxes[0].y1)
    assert boxes[2].y1 == pytest.approx(boxes[0].y1)
    (bar,) = [line for line in slanting.lines if line.get_gid() == "scale bar"]
    assert np.ptp(bar.get_xdata()) == pytest.approx(nice_length(0.2 * np.ptp(slanting.get_xlim())))


def test_a_slanting_view_leaves_out_walls_before_the_flow_and_keeps_pillars(pillar):
    snapshot, view = pillar[0], whole_space(3)
    space = Space.around([snapshot], view)
    position = snapshot["position"]
    fixed = snapshot["fixed"]
    column = fixed & (abs(position - [0.6, 0.2, 0.4]) < [0.1, 0.1, 0.3]).all(axis=1)
    floor = (position > [0, 0, -0.06]).all(axis=1) & (position < [0.8, 0.4, 0]).all(axis=1)
    for away in (np.array([0.45, 0.8, -0.42]), DOWN):
        shown = space.shows(snapshot, position, away)
        assert shown[~fixed].all()
        assert shown[column & (position[:, 2] < 0.3)].all()
        assert shown[floor].all()
    oblique = space.shows(snapshot, position, np.array([0.45, 0.8, -0.42]))
    assert not oblique[fixed & (position[:, 1] < 0)].any()  # the near wall
    assert oblique[fixed & (position[:, 1] > 0.4) & (position[:, 0] > 0)].any()  # the far one
