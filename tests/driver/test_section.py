"""Sections: discharge, depth and speed across a line on the map."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.measure.hydrographs import passage
from doseki.scenario.gauges.gauge import Setting
from doseki.scenario.gauges.section import Section

WEST, SOUTH, DP, RHO = 460_000.0, 5_200_000.0, 0.1, 1200.0
WIDE, DEEP, LONG, SPEED = 4.0, 0.5, 6.0, 2.0


def setting(dim=3):
    zeros = np.zeros(dim)
    return Setting(
        dim=dim, dp=DP, timestep=1e-3, scheme="resolved", gravity=zeros, periodic=(), domain=None,
        fixed={}, kinematics={}, material_names=["water", "mud"], body_names=[], named={},
    )  # fmt: skip


class Stream:
    """A block of water that moves along `heading` across the origin of a map."""

    def __init__(self, heading=0.0, origin=(WEST, SOUTH), speed=SPEED, jitter=0.0):
        axes = [np.arange(a + DP / 2, b, DP) for a, b in ((-LONG, 0), (0, WIDE), (0, DEEP))]
        self._x = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
        self._x += np.random.default_rng(1).uniform(-jitter, jitter, self._x.shape) * DP
        c, s = np.cos(heading), np.sin(heading)
        self._turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        self._origin, self._speed, self.time = np.array([*origin, 900.0]), speed, 0.0

    def at(self, time):
        self.time = time
        return self

    def place(self, x, y):
        """Where on the map a point lies, downstream of the origin and to the left of it."""
        return list(map(float, (self._turn @ (x, y, 0) + self._origin)[:2]))

    def sample(self, low, high):
        ahead = self._x + np.array([self._speed * self.time, 0, 0])
        position = ahead @ self._turn.T + self._origin
        inside = ((position >= low) & (position <= high)).all(axis=1)
        n = int(inside.sum())
        return {
            "position": position[inside],
            "velocity": np.tile(self._turn @ (self._speed, 0, 0), (n, 1)),
            "mass": np.full(n, RHO * DP**3), "density": np.full(n, RHO),
            "pressure": np.zeros(n), "motion": np.zeros(n, np.int32),
            "material": np.zeros(n, np.int32),
        }  # fmt: skip


def section(stream, x=2.0, low=-1.0, high=WIDE + 1, **keys):
    banks = {"left": stream.place(x, high), "right": stream.place(x, low)}
    return Section.model_construct(
        kind="section", **({"length": None, "material": None} | banks | keys)
    )


def record(gauge, stream, times):
    rows = np.array([gauge.read(stream.at(t), setting())[0] for t in times])
    return dict(zip(gauge.columns(3), rows.T, strict=True))


@pytest.mark.parametrize("heading", [0.0, 0.7, 2.0, -2.8])
@pytest.mark.parametrize("origin", [(0.0, 0.0), (WEST, SOUTH)])
def test_a_stream_of_known_discharge(heading, origin):
    """Whichever way it flows over the map, and wherever that is."""
    stream = Stream(heading, origin)
    found = record(section(stream), stream, [2.0])
    assert found["discharge"][0] == pytest.approx(WIDE * DEEP * SPEED, rel=1e-6)
    assert found["mass_rate"][0] == pytest.approx(RHO * WIDE * DEEP * SPEED, rel=1e-6)
    assert found["area"][0] == pytest.approx(WIDE * DEEP, rel=1e-6)
    assert found["width"][0] == pytest.approx(WIDE, rel=0.06)  # by whole strips
    assert found["depth"][0] == pytest.approx(DEEP, rel=0.06)
    assert found["speed"][0] == pytest.approx(SPEED, rel=1e-6)


def test_upstream_is_negative():
    stream = Stream()
    gauge = section(stream)
    turned = section(stream, low=WIDE + 1, high=-1.0)
    assert record(turned, stream, [2.0])["discharge"] == -record(gauge, stream, [2.0])["discharge"]


def test_what_shifting_carries_counts():
    """Particles go with their velocity and with what shifts them."""

    class Shifted(Stream):
        def sample(self, low, high):
            state = super().sample(low, high)
            return state | {"velocity": 0.75 * state["velocity"], "shift": 0.25 * state["velocity"]}

    whole, shifted = (record(section(s), s, [2.0]) for s in (Stream(), Shifted()))
    assert shifted["discharge"] == pytest.approx(whole["discharge"], rel=1e-12)


@pytest.mark.parametrize("length", [None, 1.0])
def test_what_passes_is_what_is_downstream(length):
    """The integral of the discharge is the volume beyond the section, while and after it passes.

    Away from the section; a control at half the section loses half of it.
    """
    stream = Stream(0.4, jitter=0.2)
    times = np.arange(0, 5.0001, 0.01)
    whole = record(section(stream, length=length), stream, times)
    volume = LONG * WIDE * DEEP
    rate, dt = whole["discharge"], np.diff(times)
    passed = np.concatenate([[0], np.cumsum(dt * (rate[1:] + rate[:-1]) / 2)])
    assert passed[-1] == pytest.approx(volume, rel=2e-3)
    middle = np.searchsorted(times, 2.5)  # half way: 5 m have left the start, 3 m are beyond
    assert passed[middle] == pytest.approx(3.0 * WIDE * DEEP, rel=5e-3)
    half = record(section(stream, high=WIDE / 2, length=length), stream, times)
    assert passage(half).volume == pytest.approx(volume / 2, rel=0.01)


def test_the_passage():
    stream = Stream()
    found = passage(record(section(stream), stream, np.arange(0, 6, 0.05)))
    assert found.arrival == pytest.approx(1.0, abs=0.15)  # 2 m at 2 m/s, less half of the slab
    assert found.peak == pytest.approx(WIDE * DEEP * SPEED, rel=0.1)
    assert found.volume == pytest.approx(LONG * WIDE * DEEP, rel=0.01)
    assert found.speed == pytest.approx(SPEED)


def test_a_film_is_no_depth():
    """Beside the stream is a film a tenth of dp deep: it has area and discharge, not width."""

    class WithFilm(Stream):
        def sample(self, low, high):
            found = super().sample(low, high)
            film = found["position"][:, 1] - SOUTH < WIDE / 2
            return found | {"mass": np.where(film, 0.02, 1.0) * found["mass"]}

    both = record(section(WithFilm()), WithFilm(), [2.0])
    assert both["width"][0] == pytest.approx(WIDE / 2, rel=0.06)
    assert both["depth"][0] == pytest.approx(DEEP, rel=0.06)
    assert both["area"][0] == pytest.approx(1.02 * WIDE / 2 * DEEP, rel=1e-6)


def test_a_dry_section():
    stream = Stream()
    found = record(section(stream, x=500.0), stream, [0.0, 1.0])
    assert (found["discharge"] == 0).all()
    assert np.isnan(found["depth"]).all()
    assert passage(found).arrival is None


def test_only_a_material():
    stream = Stream()
    assert record(section(stream, material="mud"), stream, [2.0])["area"][0] == 0
    assert record(section(stream, material="water"), stream, [2.0])["area"][0] > 0


TANK = """
dim = 3
dp = 0.1
time_max = 1
time_out = 0.1
[body.block]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [1, 1, 0.5]
[gauge.s]
kind = "section"
"""


@pytest.mark.parametrize(
    ("keys", "word"),
    [
        ("left = [0, 0]", "gauge.s.right is missing"),
        ("left = [0, 0]\nright = [0, 0.1]", "from the left bank; at least 2 dp"),
        ("left = [0, 0, 0]\nright = [0, 1]", "2 entries are needed"),
        (
            "left = [0, 0]\nright = [0, 1]\nlength = 0.05",
            "length = 0.05 m is smaller than a particle, dp =",
        ),
        ("left = [0, 0]\nright = [0, 1]\nposition = [0, 0, 0]", "position"),
        ("left = [0, 0]\nright = [0, 'x m']", "right"),
    ],
)
def test_what_is_no_section_is_refused(tmp_path, error_of, keys, word):
    path = tmp_path / "case.toml"
    path.write_text(TANK + keys)
    assert word in error_of(str(path))


@pytest.mark.parametrize("key", ["left", "right"])
def test_the_bank_that_was_changed_is_blamed(tmp_path, error_of, key):
    path = tmp_path / "case.toml"
    path.write_text(TANK + "left = [0, 0]\nright = [0, 1]")
    same = {"left": [0, 1], "right": [0, 0]}[key]
    assert error_of(path, f"gauge.s.{key}={same}").startswith(f"--set gauge.s.{key}: ")


def test_a_2d_run_has_none(tmp_path, error_of):
    path = tmp_path / "case.toml"
    path.write_text(
        TANK.replace("dim = 3", "dim = 2")
        .replace("[0, 0, 0]", "[0, 0]")
        .replace("[1, 1, 0.5]", "[1, 1]")
    )
    assert 'use "discharge"' in error_of(str(path))
