"""The x-t diagram of depth: a wave that travels has its speed as the slope of the picture."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.figures.kinds.registry import draw
from doseki.figures.kinds.xt import depths_along
from doseki.figures.plot import plot_run
from doseki.measure.views import tables
from doseki.record.reader import load
from doseki.record.writer import Recorder
from doseki.scenario.load import load_scenario
from doseki.scenario.tables.figure import Figure

from ..small_scenarios import BLOCK
from ..synthetic_runs import make_plain_state

DP, LENGTH, H0, WAVE, WIDTH, SPEED = 0.02, 2.0, 0.2, 0.1, 0.15, 1.25
TIMES = (0.0, 0.1, 0.2, 0.4, 0.5)  # one is missing
SCENARIO = """\
schema = 1
dim = {dim}
dp = 0.02
time_max = 0.5
time_out = 0.1
gravity = {gravity}

[figure.wave]
kind = "xt"
start = {start}
end = {end}
count = 80
{more}
"""


def height(x, t):
    """A hump that starts at 0.5 m."""
    return H0 + WAVE * np.exp(-(((x - 0.5 - SPEED * t) / WIDTH) ** 2))


def water_at(t, dim):
    """Water of that height over a bed, each column filled evenly to its height."""
    columns = DP * (np.arange(round(LENGTH / DP)) + 0.5)
    layers = round(H0 / DP)
    share = (np.arange(layers) + 0.5) / layers
    across = DP * (np.arange(-5, 5) + 0.5) if dim == 3 else np.zeros(1)
    x, y, s = (a.ravel() for a in np.meshgrid(columns, across, share, indexing="ij"))
    bx, by, bz = (
        a.ravel() for a in np.meshgrid(columns, across, -DP * (np.arange(3) + 0.5), indexing="ij")
    )
    position = np.stack([np.r_[x, bx], np.r_[y, by], np.r_[s * height(x, t), bz]], axis=1)
    position = position if dim == 3 else position[:, [0, 2]]
    wall = np.arange(len(position)) >= len(x)
    state = make_plain_state(position, np.zeros_like(position), np.where(wall, 2, 0))
    volume = np.r_[DP ** (dim - 1) * height(x, t) / layers, np.full(len(bx), DP**dim)]
    return state | {"mass": 1000 * volume, "density": np.full(len(position), 1000.0)}


def at(dim, x):
    return [x, 0.0] if dim == 2 else [x, 0.0, 0.0]


@pytest.fixture
def recorded(tmp_path):
    """A run with the wave, and a figure of it."""

    def record(dim=2, start=0.1, end=1.9, more=""):
        gravity = [0.0] * (dim - 1) + [-9.8]
        text = SCENARIO.format(
            dim=dim, gravity=gravity, start=at(dim, start), end=at(dim, end), more=more
        )
        names = ["water", "basalt", "aluminium"], ["sea", "grain", "bed"]
        recorder = Recorder(tmp_path / "run", text, *names, dim)
        for step, t in enumerate(TIMES):
            recorder.snapshot(water_at(t, dim), time=t, step=step, dt=1e-3)
        run = load(tmp_path / "run")
        return run, tables(run, "figure", Figure)["wave"]

    return record


def slope(distances, times, depth):
    """The speed of the middle of the hump in a picture, m/s."""
    hump = depth - H0
    middle = (hump * distances).sum(axis=1) / hump.sum(axis=1)
    return np.polyfit(times, middle, 1)[0]


@pytest.mark.parametrize("dim", [2, 3])
def test_depths_are_those_of_the_wave(recorded, dim):
    found = depths_along(*recorded(dim))
    np.testing.assert_allclose(found.times, TIMES)
    np.testing.assert_allclose(found.distances, 1.8 * (np.arange(80) + 0.5) / 80)
    true = height(0.1 + found.distances, found.times[:, None])
    np.testing.assert_allclose(found.depth, true, atol=0.25 * DP)


def test_the_slope_in_the_picture_is_the_speed_of_the_wave(recorded):
    run, table = recorded()
    (axes, bar) = draw(run, "wave", table).axes
    mesh = axes.collections[0]
    corners = mesh.get_coordinates()
    x = 0.5 * (corners[0, 1:, 0] + corners[0, :-1, 0])
    t = TIMES  # the cells are of unequal height: each holds its moment
    assert all(
        low < time < high
        for low, time, high in zip(corners[:, 0, 1], t, corners[1:, 0, 1], strict=False)
    )
    assert slope(x, t, np.asarray(mesh.get_array())) == pytest.approx(SPEED, rel=0.01)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("distance along the line (m)", "time (s)")
    assert bar.get_ylabel() == "depth (m)"


def test_a_line_the_other_way_has_the_opposite_slope(recorded):
    found = depths_along(*recorded(start=1.9, end=0.1))
    assert slope(found.distances, found.times, found.depth) == pytest.approx(-SPEED, rel=0.01)


def test_the_slope_of_what_stands_still_is_zero(recorded, monkeypatch):
    """The control: the estimate of the slope does not see what is not there."""
    monkeypatch.setitem(globals(), "SPEED", 0.0)
    found = depths_along(*recorded())
    assert abs(slope(found.distances, found.times, found.depth)) < 0.01


def test_another_material_and_a_dry_place_have_no_depth(recorded):
    assert not depths_along(*recorded(more='material = "basalt"')).depth.any()


def test_beyond_the_water_it_is_dry(recorded):
    found = depths_along(*recorded(end=3.1))
    beyond = 0.1 + found.distances > LENGTH + 3 * DP
    assert not found.depth[:, beyond].any()
    assert found.depth[:, ~beyond][:, :-5].all()


def test_it_is_one_of_the_figures_of_a_run(recorded):
    run, _ = recorded()
    assert "wave.png" in [file.name for file in plot_run(run.directory)]


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("start = [0, 0]", "figure.f.end is missing"),
        ("start = [0, 0]\nend = [0, 0]", "figure.f: start and end are the same point"),
        ("start = [0, 0]\nend = [1, 0]\ncount = 0", "figure.f.count = 0 is out of range"),
        ("start = [0, 0]\nend = [1, 0]\nmaterial = 'watr'", "did you mean water?"),
        ("start = [0, 0]\nend = [1, 0, 0]", "a 2-D run needs 2 entries"),
        ("start = [0, 0]\nend = [1, 0]\ntimes = [0]", "figure.f.times is not a known key"),
    ],
)
def test_wrong_keys(tmp_path, keys, said):
    file = tmp_path / "case.toml"
    top = "dim = 2\ndp = 0.1\ntime_max = 1\ntime_out = 0.1\n"
    file.write_text(f'{top}{BLOCK}\n[figure.f]\nkind = "xt"\n{keys}\n')
    with pytest.raises(UserError) as caught:
        load_scenario(str(file))
    assert said in str(caught.value)
