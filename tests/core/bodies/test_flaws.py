"""Random flaws: large bodies are weaker, by Weibull's exponent; 2-D."""

from __future__ import annotations

import math

import numpy as np
import pytest

from .breaking import ROCK, Bar

SEEDS = range(1, 31)
LENGTH = 0.05  # m, of a small bar
STRAIN = 2e-4  # below which a bar of 1e-3 m3 has one flaw


class Bars:
    """Bars of one shape and size with different flaws, pulled until they break."""

    def __init__(self, core, m, size=1.0, count=(1, 1), rows=8):
        """`count` times as many points along and across as a bar of `rows`; all `size` as large."""
        self.core, self.across, self.m = core, count[1] * rows, m
        self.length = size * count[0] * LENGTH
        self.kind = type("SizedBar", (Bar,), {"width": size * count[1] * Bar.width})
        self.volume = self.length * self.kind.width  # m3: in 2-D a body is 1 m across
        self.flaws = {
            "fracture": "grady_kipp", "weibull_m": m,
            "weibull_k": 1 / (LENGTH * Bar.width * STRAIN**m),
        }  # fmt: skip

    def strengths(self, seeds=SEEDS, slowness=40.0, turn=None):
        """Highest mean stress of each, Pa; all is turned by a matrix."""
        found = []
        for seed in seeds:
            flaws = self.flaws | {"flaw_seed": seed}
            bar = self.kind(
                self.core, self.across, rows_cut=0, length=self.length, turn=turn, **flaws
            )
            bar.pull(2.5 * STRAIN * self.length, slowness, rows=150)
            found.append(bar.stress.max())
            assert bar.stress[-1] < 0.97 * found[-1], "it did not break"
        return np.array(found)


def ratio(large, small):
    """Of the means, and its standard error."""
    parts = [
        values.std(ddof=1) / values.mean() / math.sqrt(len(values)) for values in (large, small)
    ]
    value = large.mean() / small.mean()
    return value, value * math.hypot(*parts)


EIGHT_TIMES = math.sqrt(8)  # of length and width: volumes are as 8 to 1
OTHERS = range(101, 131)  # flaws of large bars are not those of small ones


@pytest.mark.minutes
@pytest.mark.parametrize(
    ("m", "other"), [(8.5, 4.0), pytest.param(4.0, 8.5, marks=pytest.mark.full)]
)
def test_eight_times_the_volume_is_weaker_by_the_exponent(core, m, other):
    """30 bars of each size with as many points: within 10 % of 8^(-1/m), not of another m.

    The mean is that of Weibull's law for the weakest flaw: its crack runs on, Eq. (143).
    """
    small, large = Bars(core, m), Bars(core, m, size=EIGHT_TIMES)
    assert large.volume == pytest.approx(8 * small.volume)
    bars = small.strengths()
    found, error = ratio(large.strengths(OTHERS), bars)
    assert error < 0.045  # strengths scatter as Weibull's do
    assert found == pytest.approx(8 ** (-1 / m), rel=0.10)
    assert found != pytest.approx(8 ** (-1 / other), rel=0.10)
    weakest = ROCK["young_modulus"] * STRAIN * math.gamma(1 + 1 / m)
    assert 1.0 < bars.mean() / weakest < 1.2


C, S = math.cos(math.pi / 6), math.sin(math.pi / 6)


@pytest.mark.parametrize(
    "turn", [[[C, -S], [S, C]], [[1, 0], [0, -1]], [[C, S], [S, -C]]], ids=["30", "mirror", "both"]
)
def test_cracks_run_on_alike_in_a_bar_that_is_turned_or_mirrored(core, turn):
    """The same flaws in a bar at 30 degrees to the axes, its mirror image, and both."""
    bars, seeds = Bars(core, 8.5), (1, 2)
    np.testing.assert_allclose(
        bars.strengths(seeds, turn=np.array(turn)), bars.strengths(seeds), rtol=1e-6
    )


@pytest.mark.full
def test_half_the_speed_changes_the_mean_strength_little(core):
    bars = Bars(core, 8.5)
    assert bars.strengths(slowness=80.0).mean() == pytest.approx(bars.strengths().mean(), rel=0.02)


@pytest.mark.full
def test_eight_times_the_points_are_weaker_by_the_exponent(core):
    """Of one spacing, four times as long and twice as wide; 0.92 where cracks do not run on."""
    small, large = Bars(core, 8.5), Bars(core, 8.5, count=(4, 2))
    assert large.volume == pytest.approx(8 * small.volume)
    found, error = ratio(large.strengths(OTHERS, slowness=20.0), small.strengths())
    assert error < 0.04
    assert found == pytest.approx(8 ** (-1 / 8.5), rel=0.10)
