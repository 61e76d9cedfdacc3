"""Pictures: every particle where it belongs, in its colour, in a file of a readable shape."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
from matplotlib import colors, image
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from PIL import Image
from typer.testing import CliRunner

from doseki.cli.app import app
from doseki.errors import UserError
from doseki.figures import movie, stage
from doseki.figures.colouring import FIXED_COLOUR, FLUID_COLOURS, SOLID_COLOURS, colouring, limits
from doseki.figures.dots import dots, extent_of
from doseki.figures.flow import draw_flow
from doseki.figures.kinds.histogram import SpeedHistogram, draw_speed_row
from doseki.figures.kinds.panels import Panels
from doseki.figures.kinds.snapshot import draw_panels
from doseki.figures.movie import make_movie
from doseki.figures.panel import draw_panel
from doseki.figures.plot import figures, plot_run
from doseki.figures.raster import EMPTY, coloured, splat
from doseki.measure.census.census import draw_speeds
from doseki.measure.moments import Moment
from doseki.measure.quantities import quantity
from doseki.measure.views import View, named_window, whole_space
from doseki.record.quantities import quantity_label
from doseki.record.reader import load

from ..synthetic_runs import make_plain_state


def test_splat_paints_discs_at_their_places_and_later_over_earlier():
    points = np.array([[0.5, 0.5], [2.5, 1.5], [2.5, 1.5]])
    shown = splat(points, np.array([0.1, 0.1, 1.0]), (0.0, 4.0, 0.0, 2.0), 4)
    assert shown.tolist() == [[EMPTY, 2, 2, 2], [0, EMPTY, 2, EMPTY]]


def test_splat_leaves_out_what_is_outside():
    points = np.array([[-0.5, 0.5], [4.5, 0.5], [0.5, 2.5], [0.5, -0.5]])
    assert np.all(splat(points, np.full(4, 0.1), (0.0, 4.0, 0.0, 2.0), 4) == EMPTY)


def test_coloured_gives_background_to_empty_pixels():
    picture = coloured(np.array([[EMPTY, 0]]), np.array([[1, 2, 3]], np.uint8), (9, 9, 9))
    assert picture.tolist() == [[[9, 9, 9], [1, 2, 3]]]


def test_dots_have_the_area_of_the_particles_or_the_radius_of_their_support(two_grains):
    snapshot = load(two_grains)[0]
    grain, support = (dots(snapshot, whole_space(2), size) for size in ("grain", "support"))
    assert np.allclose(np.pi * grain.radius**2, snapshot["mass"] / snapshot["density"])
    assert np.allclose(support.radius, 2.5 * snapshot["smoothing_length"])


def test_extent_of_a_window_is_the_window_and_of_all_space_holds_the_circles(
    flow_folder, two_grains
):
    run = load(flow_folder)
    assert extent_of([run[0]], named_window(run, "end")) == (0.0, 1.0, -0.1, 0.3)
    left, right, bottom, top = extent_of([load(two_grains)[0]], whole_space(2), "support")
    assert left < -1.3 < 1.3 < right
    assert bottom < -0.3 < 0.3 < top


def test_a_stray_particle_does_not_shrink_the_picture(tmp_path, record_run, plain_state):
    cloud = np.random.default_rng(0).uniform(size=(5000, 2))
    position = np.vstack([cloud, [[100.0, 0.5]]])
    state = plain_state(position, np.zeros((5001, 2)), np.zeros(5001, int))
    record_run(tmp_path / "run", times=(0.0,), state_at=lambda _time: state)
    extent = extent_of([load(tmp_path / "run")[0]], whole_space(2))
    assert 1.0 < extent[1] < 1.5


def test_materials_have_the_colours_of_the_paper(flow_folder):
    run = load(flow_folder)
    snapshot = run[-1]
    rgba = colouring(run, [snapshot], "material", whole_space(2)).rgba(snapshot)
    wanted = {"water": FLUID_COLOURS[0], "basalt": SOLID_COLOURS[0], "aluminium": FIXED_COLOUR}
    for name, colour in wanted.items():
        assert np.all(rgba[snapshot["material"] == name] == colors.to_rgba(colour))


def test_fixed_particles_are_black_even_where_others_of_their_material_move(
    tmp_path, record_run, plain_state
):
    state = plain_state(np.eye(2), np.zeros((2, 2)), np.array([1, 1]))
    state["motion"] = np.array([0, 1], np.int32)
    record_run(tmp_path / "run", times=(0.0,), state_at=lambda _time: state)
    run = load(tmp_path / "run")
    colours = colouring(run, [run[0]], "material", whole_space(2))
    wanted = [SOLID_COLOURS[0], FIXED_COLOUR]
    assert np.allclose(colours.rgba(run[0]), [colors.to_rgba(colour) for colour in wanted])
    labels = [label for label, _ in colours.legend_entries()]
    assert labels == ["basalt", "basalt (fixed)"]


def test_colour_scale_spans_the_particles_that_move(flow_folder):
    run = load(flow_folder)
    scale = colouring(run, [run[-1]], "velocity_x", whole_space(2))
    labels = [label for label, _ in scale.legend_entries()]
    assert (labels[0], labels[-1]) == ("-1", "-0.5")
    assert scale.heading == "velocity x (m/s)"


def test_a_scale_has_no_values_that_nothing_has(flow_folder):
    run = load(flow_folder)
    scale = colouring(run, [run[-1]], "pressure", whole_space(2))  # 0 everywhere
    assert [label for label, _ in scale.legend_entries()] == ["0"]
    assert np.isfinite(scale.rgba(run[-1])).all()
    axes = Figure().subplots()
    draw_panel(axes, run, run[-1], "pressure", whole_space(2))
    [key] = axes.child_axes
    assert key.get_ylabel() == "pressure (Pa)"
    assert [tick.get_text() for tick in key.get_yticklabels()] == ["0"]
    assert key.get_facecolor() == colors.to_rgba(scale.legend_entries()[0][1])
    many = np.zeros(10_000)
    assert limits(many) == (0, 0)
    many[:3] = 5.0  # fewer than are left out
    assert limits(many) == (0, 5)


def test_quantities_by_name(run_folder):
    snapshot = load(run_folder)[0]
    assert np.array_equal(quantity(snapshot, "velocity_y"), snapshot["velocity"][:, 1])
    assert np.array_equal(quantity(snapshot, "stress_xy"), snapshot["stress"][:, 0, 1])
    assert np.allclose(quantity(snapshot, "speed") ** 2, (snapshot["velocity"] ** 2).sum(axis=1))
    assert quantity_label("stress_xy", 2) == "stress xy (Pa)"
    assert quantity_label("mass", 3) == "mass (kg)"
    assert quantity_label("mass", 2) == "mass (kg/m)"
    with pytest.raises(UserError, match="did you mean velocity_x"):
        quantity(snapshot, "velocityx")
    with pytest.raises(UserError, match="velocity_z"):
        quantity(snapshot, "velocity_z")


def test_snapshot_panels_are_true_to_scale_and_hold_every_particle(two_grains):
    run = load(two_grains)
    what = Panels(whole_space(2), ["speed"], sizes=("support", "grain"))
    figure = draw_panels(run, [Moment(0, ""), Moment(len(run) - 1, "")], what)
    figure.canvas.draw()
    panels = [axes for axes in figure.axes if axes.get_aspect() == 1.0]
    assert len(panels) == 4
    for axes in panels:
        (circles,) = [c for c in axes.collections if isinstance(c, EllipseCollection)]
        assert len(circles.get_offsets()) == 2
        wanted = 0.3 if "radius H h" in axes.get_title(loc="left") else 0.1 / np.sqrt(np.pi)
        assert np.allclose(circles.get_widths(), 2 * wanted)
        assert np.allclose(circles.get_heights(), 2 * wanted)
        box = axes.get_window_extent()
        assert box.width / np.diff(axes.get_xlim()) == pytest.approx(
            box.height / np.diff(axes.get_ylim())
        )


def test_plot_run_writes_the_figures_of_the_scenario_and_the_general_ones(flow_folder):
    files = plot_run(flow_folder)
    names = {"overview", "energy", "mass", "flow", "before", "energies"}
    assert {path.stem for path in files} == names
    for path in files:
        height, width, _ = image.imread(path).shape
        assert 300 < width < 2500
        assert 150 < height < 3000


def test_figures_show_red_grains_black_bed_and_blue_water(flow_folder):
    plot_run(flow_folder)
    pixels = np.round(255 * image.imread(flow_folder / "figures/overview.png")[..., :3]).astype(int)
    for colour in (FLUID_COLOURS[0], SOLID_COLOURS[0], FIXED_COLOUR):
        wanted = np.round(255 * np.array(colors.to_rgb(colour))).astype(int)
        assert np.count_nonzero(np.all(np.abs(pixels - wanted) <= 1, axis=2)) > 20


def test_a_run_of_few_particles_also_shows_the_support(two_grains, flow_folder):
    titles = [axes.get_title(loc="left") for axes in dict(figures(load(two_grains)))["pair"].axes]
    assert any("radius H h" in title for title in titles)
    titles = [
        axes.get_title(loc="left") for axes in dict(figures(load(flow_folder)))["before"].axes
    ]
    assert not any("radius H h" in title for title in titles)


def test_a_figure_of_the_scenario_replaces_the_general_one_of_its_name(two_grains):
    scenario = two_grains / "scenario.toml"
    scenario.write_text(scenario.read_text().replace("[figure.pair]", "[figure.overview]"))
    names = [name for name, _ in figures(load(two_grains))]
    assert sorted(names) == ["energy", "mass", "overview"]


def test_a_run_in_three_dimensions_is_drawn(tmp_path, record_run):
    record_run(tmp_path / "run", dim=3)
    assert [path.stem for path in plot_run(tmp_path / "run")] == [
        "overview",
        "energy",
        "mass",
        "flow",
    ]


def test_a_run_without_snapshots_cannot_be_drawn(tmp_path, record_run):
    record_run(tmp_path / "run", times=())
    with pytest.raises(UserError, match="no snapshot"):
        plot_run(tmp_path / "run")


def test_a_figure_that_was_made_impossible_by_hand_is_named(two_grains):
    scenario = two_grains / "scenario.toml"
    scenario.write_text(scenario.read_text().replace('kind = "snapshot"', 'kind = "sculpture"'))
    with pytest.raises(UserError, match=r"line 10: figure\.pair\.kind = .sculpture"):
        plot_run(two_grains)


@pytest.mark.parametrize(
    ("name", "colour", "window"),
    [("m.gif", "material", None), ("m.gif", "velocity_x", "end"), ("m.webp", "material", None)],
)
def test_movies_have_one_frame_per_snapshot(flow_folder, tmp_path, name, colour, window):
    run = load(flow_folder)
    with Image.open(make_movie(run, tmp_path / name, colour, window, width=300)) as frames:
        assert frames.width == 300 + stage.LEFT + stage.RIGHT
        assert frames.n_frames == len(run)
        first = np.asarray(frames.convert("RGB"))
        frames.seek(len(run) - 1)
        assert np.any(np.asarray(frames.convert("RGB")) != first)


def test_a_gif_keeps_the_colours_of_its_key_in_all_frames(flow_folder, tmp_path):
    run = load(flow_folder)
    camera = movie._Camera(run, "velocity_x", None, width=300)
    key = [np.round(255 * np.array(colors.to_rgb(c))) for _, c in camera._colours.legend_entries()]
    with Image.open(make_movie(run, tmp_path / "m.gif", "velocity_x", width=300)) as frames:
        for k, frame in enumerate(camera.frames()):
            frames.seek(k)
            shown, wanted = np.asarray(frames.convert("RGB")).astype(int), np.asarray(frame)
            assert np.abs(shown - wanted).max() <= 4
            seen = [(wanted == colour).all(axis=2) for colour in key]
            assert sum(mask.sum() > 20 for mask in seen) > 3
            for colour, mask in zip(key, seen, strict=True):
                assert (shown[mask] == colour).all()
    assert len({tuple(colour) for colour in key}) == len(key)


def test_movies_of_space_show_surfaces_from_the_side(tmp_path, record_run):
    """A block of water in front of a stone: it covers the stone, and axes and bar are there."""

    def state(time):
        grid = np.stack(np.meshgrid(*[np.arange(0.0, 1.0, 0.1)] * 3), axis=-1).reshape(-1, 3)
        stone = grid[(grid[:, 1] > 0.45) & (grid[:, 2] < 0.5)]
        water = grid[grid[:, 1] < 0.45] + [time, 0, 0]
        kind = np.repeat([0, 1], [len(water), len(stone)])
        return make_plain_state(np.concatenate([water, stone]), np.zeros((len(kind), 3)), kind)

    window = "\n[window.all]\nmin = [-9.0, -9.0, -9.0]\nmax = [9.0, 9.0, 9.0]\n"
    record_run(tmp_path / "run", dim=3, times=(0.0, 2.0), state_at=state, tables=window)
    camera = movie._Camera(load(tmp_path / "run"), "material", "all", width=120)
    first, last = (np.asarray(frame, int) for frame in camera.frames())
    (axes,) = camera.stage.figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (m)", "z (m)")
    assert [each.get_gid() for each in camera.stage.figure.artists] == ["scale bar"]
    left, right, bottom, top = (*axes.get_xlim(), *axes.get_ylim())
    box = axes.get_position()
    column = round((box.x0 + box.width * (0.5 - left) / (right - left)) * first.shape[1])
    row = round((1 - box.y0 - box.height * (0.25 - bottom) / (top - bottom)) * first.shape[0])
    stone, covered = last[row, column], first[row, column]
    assert stone[0] > 2 * stone[2]
    assert covered[2] > stone[2] + 20
    assert covered[0] > covered[2] / 3


def test_a_movie_of_nothing_is_refused(tmp_path, record_run):
    def nothing(_time):
        return make_plain_state(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, int))

    record_run(tmp_path / "run", dim=3, times=(0.0,), state_at=nothing)
    with pytest.raises(UserError, match="no movie: there are no particles"):
        make_movie(load(tmp_path / "run"), tmp_path / "m.gif")
    assert "overview" not in [path.stem for path in plot_run(tmp_path / "run")]


def test_mp4_needs_ffmpeg(flow_folder, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match="needs the program ffmpeg"):
        make_movie(load(flow_folder), tmp_path / "m.mp4")
    assert not (tmp_path / "m.mp4").exists()


def test_a_movie_that_cannot_be_made_is_refused_before_figures_are_drawn(flow_folder, tmp_path):
    done = CliRunner().invoke(app, ["plot", str(flow_folder), "--movie", str(tmp_path / "m.xyz")])
    assert "a movie is a .gif, a .webp or an .mp4" in str(done.exception)
    assert done.output == ""


def test_movie_refuses_other_endings_and_existing_files(flow_folder, tmp_path):
    (tmp_path / "m.gif").write_text("mine")
    with pytest.raises(UserError, match="exists"):
        make_movie(load(flow_folder), tmp_path / "m.gif")
    with pytest.raises(UserError, match=r"\.webp or an \.mp4"):
        make_movie(load(flow_folder), tmp_path / "m.avi")


def test_a_speed_that_few_samples_have_can_be_drawn():
    """Its mean over the samples is above the 95th percentile, which is zero."""
    speeds = np.r_[np.full(2000, 0.55), 3.05]
    draw_speed_row(Figure().subplots(1, 2), draw_speeds(speeds), "grains")


class OneBody(dict):
    """A snapshot with a body of three particles, one of them beside the window, and a drop."""

    dim = 2
    grains: ClassVar = {"position": np.array([[0.5, 0.0]]), "velocity": np.array([[2.0, 0.0]])}


def test_a_body_is_counted_once_and_drops_each():
    snapshot = OneBody(
        position=np.array([[0.4, 0.0], [0.6, 0.0], [1.1, 0.0], [0.2, 0.0]]),
        velocity=np.array([[1.0, 0.0], [3.0, 0.0], [2.0, 0.0], [0.5, 0.0]]),
        fixed=np.zeros(4, bool),
        material=np.array(["rock", "rock", "rock", "water"]),
        grain=np.array([0, 0, 0, -1]),
    )
    view = View(np.zeros(2), np.ones(2))
    assert SpeedHistogram(view, "rock").speeds(snapshot).tolist() == [2.0]
    assert SpeedHistogram(view).speeds(snapshot).tolist() == [0.5, 2.0]
    apart = View(np.array([0.55, 0.0]), np.ones(2))
    assert SpeedHistogram(apart, "rock").speeds(snapshot).tolist() == []
    between_its_particles = View(np.array([0.45, 0.0]), np.array([0.55, 1.0]))
    assert SpeedHistogram(between_its_particles, "rock").speeds(snapshot).tolist() == [2.0]


def test_a_colour_without_a_movie_is_refused(flow_folder):
    said = CliRunner().invoke(app, ["plot", str(flow_folder), "--colour", "speed"])
    assert isinstance(said.exception, UserError)
    assert "--colour speed is that of a movie: give --movie FILE" in str(said.exception)
    assert not list(flow_folder.rglob("*.png"))


def test_coordinates_of_a_map_are_drawn_in_full(flow_folder):
    """Without an offset or an exponent, which a reader would have to add."""
    times = [0.0, 1.0, 2.0]
    fronts = [5211020.0, 5211030.0, 5211040.0]
    flow = SimpleNamespace(times=times, front=fronts, windows={}, along_x=True)
    figure = draw_flow(load(flow_folder), flow)
    figure.canvas.draw()
    axis = figure.axes[0].yaxis
    assert axis.get_offset_text().get_text() == ""
    assert "5211030" in {label.get_text() for label in axis.get_ticklabels()}
