"""A steady jet on a plate: the force is the momentum that it loses."""

from __future__ import annotations

import numpy as np
import pytest

from .scenes import JET, run_of

SPEED, THICKNESS = 2.0, 0.1
FORCE = 1000 * SPEED**2 * THICKNESS  # per metre


def steady(run):
    """Mean force (2,) of the second half."""
    record = run.gauges["plate"]
    late = record["time"] > 0.3
    return np.array([record[f"force_{axis}"][late].mean() for axis in "xy"])


@pytest.mark.minutes
@pytest.mark.parametrize("angle", [0, 30])
def test_a_jet_loses_its_momentum(tmp_path, angle):
    """Within 3 %, along the jet, also where all is turned; without gravity nothing is static."""
    run = run_of(tmp_path, JET, f"angle={angle}")
    turn = np.radians(angle)
    along, aside = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) @ steady(
        run
    )
    assert along == pytest.approx(FORCE, rel=0.03)
    assert abs(aside) < 0.01 * FORCE
    assert not run.gauges["plate"]["static_force_x"][1:].any()


@pytest.mark.minutes
def test_a_faster_jet_presses_with_the_square_of_its_speed(tmp_path):
    """The control: a twentieth more speed is a tenth more force, outside the band."""
    force = steady(run_of(tmp_path, JET, "speed=2.1"))[0]
    assert force > 1.06 * FORCE
    assert force == pytest.approx(1.05**2 * FORCE, rel=0.03)
