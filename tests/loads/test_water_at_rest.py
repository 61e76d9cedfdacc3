"""Water at rest against a dam: the force is hydrostatic, and so is the static part."""

from __future__ import annotations

import numpy as np
import pytest

from .scenes import DAM, DAM_3D, run_of

G, H = 9.81, 0.4
FORCE, MOMENT = 0.5 * 1000 * G * H**2, 1000 * G * H**3 / 6  # per metre; about the foot


def thrust(record, part, angle):
    """Mean component (over the run) along the turned x axis, and the moment."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    x, y = (record[f"{part}force_{axis}"][1:].mean() for axis in "xy")
    return c * x + s * y, c * y - s * x, record[f"{part}moment"][1:].mean()


@pytest.mark.parametrize("angle", [0, 25])
def test_the_force_on_a_dam_is_hydrostatic(tmp_path, angle):
    """Within 1 %, also where all is turned; about the foot it turns as a triangle does."""
    run = run_of(tmp_path, DAM, f"angle={angle}")
    record = run.gauges["dam"]
    for part in ("", "static_"):
        along, up, moment = thrust(record, part, angle)
        assert along == pytest.approx(FORCE, rel=0.01)
        assert abs(up) < 0.02 * FORCE  # its foot carries a little of the water
        assert moment == pytest.approx(-MOMENT, rel=0.01)
    assert not record["contact_force_x"][1:].any()
    dynamic = thrust(record, "dynamic_", angle)[0]
    assert abs(dynamic) < 0.02 * FORCE


def test_heavier_water_is_told_apart(tmp_path):
    """The control: water that is 3 % heavier fails the band of 1 %."""
    record = run_of(tmp_path, DAM, "rho=1030").gauges["dam"]
    for part in ("", "static_"):
        assert thrust(record, part, 0)[0] > 1.015 * FORCE


def test_panels_have_the_pressure_of_their_depth(tmp_path):
    """And together the force on the face, to rounding."""
    buried = ["origin=[0.4, -0.02]", "edges=[[0, 0.54]]", "panels=[9]"]
    run = run_of(tmp_path, DAM, *(f"gauge.face.{key}" for key in buried))
    face, dam = run.gauges["face"], run.gauges["dam"]
    pressure = face["flow_pressure"].reshape(-1, 9)[1:]
    np.testing.assert_allclose(pressure.sum(axis=1) * 0.06, dam["force_x"][1:], rtol=1e-9)
    expected = 1000 * G * np.maximum(0, H + 0.02 - face["along_1"][:9])
    expected[0] = 1000 * G * (H - 0.02) * 0.04 / 0.06  # the rest of it is below the bed
    np.testing.assert_allclose(pressure.mean(axis=0), expected, atol=0.02 * 1000 * G * H)


@pytest.mark.minutes
def test_a_dam_in_three_dimensions(tmp_path):
    """Coarse, 10 particles over the depth: within 1 %, as the static part."""
    buried = ["origin=[0.6, -0.12, -0.12]", "edges=[[0, 0.64, 0], [0, 0, 0.64]]", "panels=[2, 4]"]
    run = run_of(tmp_path, DAM_3D, *(f"gauge.face.{key}" for key in buried))
    record, force = run.gauges["dam"], FORCE * 0.4
    assert record["force_x"][1:].mean() == pytest.approx(force, rel=0.01)
    assert record["static_force_x"][1:].mean() == pytest.approx(force, rel=0.01)
    assert record["static_moment_y"][1:].mean() == pytest.approx(MOMENT * 0.4, rel=0.02)
    assert record["static_moment_z"][1:].mean() == pytest.approx(-0.2 * force, rel=0.02)
    assert abs(record["force_y"][1:].mean()) < 0.01 * force
    pressure = run.gauges["face"]["flow_pressure"].reshape(-1, 4, 2)[1:]
    whole = pressure.sum(axis=(1, 2)) * 0.32 * 0.16
    np.testing.assert_allclose(whole, record["force_x"][1:], rtol=1e-9)
    np.testing.assert_allclose(pressure[:, :, 0], pressure[:, :, 1], rtol=0.02, atol=20)
