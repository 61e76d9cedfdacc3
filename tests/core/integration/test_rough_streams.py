"""A stream on a rough bed keeps the logarithmic profile of its law, whatever the speed of sound."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.validate.running import Running

DEPTH, ACROSS, COLUMNS, ANGLE = 0.1, 10, 12, np.radians(1.0)
DP = DEPTH / ACROSS
SHEAR = np.sqrt(9.81 * DEPTH * np.sin(ANGLE))  # m/s, u* of the bed
KAPPA = 0.4
STREAM = """
dim = 2
scheme = "resolved"
dp = {dp}
time_max = 6
time_out = 6
gravity = {gravity}
speed_max = {speed_max}
periodic = ["{along}"]
domain_min = {low}
domain_max = {high}
turbulence = "mixing_length"

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = {ks}
normal = {normal}
min = {bed_min}
max = {bed_max}

[body.water]
shape = "box"
material = "water"
jitter = 0.1
min = [0, 0]
max = {top}
pressure = "= 1000*9.81*cos(radians(1))*({depth} - {up})"
velocity = {velocity}
"""


def law(z, ks):
    return SHEAR / KAPPA * np.log(1 + 30 * z / ks)


def stream(ks: float, fast: float, upright: bool = False) -> str:
    """Along x on a level bed, or along -y on an upright one; it starts with the profile."""
    along, up = ("y", "x") if upright else ("x", "y")
    long, pull, press = COLUMNS * DP, 9.81 * np.sin(ANGLE), -9.81 * np.cos(ANGLE)
    profile = f"= {SHEAR / KAPPA}*log(1 + 30*{up}/{ks})"

    def pair(of_flow, upwards):
        return [upwards, of_flow] if upright else [of_flow, upwards]

    return STREAM.format(
        dp=DP, depth=DEPTH, ks=ks, along=along, up=up, speed_max=float(fast * law(DEPTH, ks)),
        gravity=[float(g) for g in pair(-pull if upright else pull, press)],
        low=pair(0.0, -3 * DP), high=pair(long, 6 * DEPTH), normal=pair(0, 1),
        bed_min=pair(0.0, -3 * DP), bed_max=pair(long, 0.0), top=pair(long, DEPTH),
        velocity=pair(profile.replace("= ", "= -") if upright else profile, 0),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("share", "fast", "upright"),
    [(0.25, 1.15, False), (0.25, 6, False), (2, 1.15, False), (0.25, 1.15, True)],
)
def test_it_keeps_the_profile_of_the_law(tmp_path, share, fast, upright):
    """Steps between rows were less than half of it, and the more so the faster sound was."""
    path, ks = tmp_path / "stream.toml", share * DP
    path.write_text(stream(ks, fast, upright), encoding="utf-8")
    run = Running(str(path))
    places, speeds = [], []
    for time in np.linspace(4, 6, 9):
        state = run.advance(time)
        water = state["body"] == run.body_names.index("water")
        places.append(state["position"][water, 0 if upright else 1])
        along = state["velocity"][water, 1 if upright else 0]
        speeds.append(-along if upright else along)
    z, u = np.concatenate(places), np.concatenate(speeds)
    assert u.mean() == pytest.approx(
        law((np.arange(1000) + 0.5) / 1000 * DEPTH, ks).mean(), rel=0.02
    )
    for row in range(4):
        there = (z >= row * DP) & (z < (row + 1) * DP)
        assert abs(u[there].mean() - law(z[there], ks).mean()) < 0.3 * SHEAR, row
