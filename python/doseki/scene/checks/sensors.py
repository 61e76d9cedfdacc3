"""Checks of sensors that are let into walls."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...record.particles import ParticleSet
from ...scenario.gauges.face import Face
from ...scenario.gauges.gauge import State
from ...scenario.gauges.pressure import PressureGauge
from ...scenario.model import Scenario
from ...util.finding import Finding, no_more_than


@dataclass(frozen=True)
class SmallSensor(Finding):
    """A sensor that is smaller than what the pressure on a wall is a mean over."""

    diameter: float  # m
    kernel: float  # m, across
    dp: float  # m

    def __str__(self) -> str:
        enough = self.dp * self.diameter / self.kernel
        return (
            f"{self.place}: a sensor {self.diameter:.3g} m across sees what one of the kernel's "
            f"{self.kernel:.3g} m does; dp = {no_more_than(enough)} would resolve it"
        )


def sensor_findings(
    scenario: Scenario, particles: ParticleSet, names: list[str], normal: np.ndarray,
    depth: np.ndarray,
) -> Iterator[Finding]:  # fmt: skip
    """A doubt about each sensor that is smaller than the kernel.

    Raises UserError for a sensor that is larger than its wall, or whose wall moves.
    """
    walls = {"position": particles.position, "motion": particles.motion}
    walls |= {"normal": normal, "depth": depth}
    for name, gauge in scenario.gauge.items():
        face = gauge.face(scenario.dp) if isinstance(gauge, PressureGauge) else None
        if face is None:
            continue
        _check_wall(scenario, name, face, walls)
        _check_rest(scenario, name, names, particles.body[face.weights(walls) > 0])
        kernel = 2 * scenario.support
        if face.diameter < kernel * (1 - 1e-9):
            yield SmallSensor(f"gauge.{name}", face.diameter, kernel, scenario.dp)


def _check_wall(scenario: Scenario, name: str, face: Face, walls: State) -> None:
    covered = face.covered(walls)
    if covered == 0:
        raise scenario.where.error(
            ("gauge", name, "position"),
            f"gauge.{name}.position = {face.position.tolist()} is not on the surface of a fixed "
            f"body, as that of a gauge with area must be",
        )
    if covered < face.least_covered:
        raise scenario.where.error(
            ("gauge", name, "area"),
            f"gauge.{name}.area = {face.area:g} is larger than the wall around its position: "
            f"{100 * covered:.0f} % of its face, {face.diameter:.3g} m across, are wall",
        )


def _check_rest(scenario: Scenario, name: str, names: list[str], bodies: np.ndarray) -> None:
    moving = {each for each, body in scenario.body.items() if body.prescribed_motion is not None}
    found = sorted(moving & {names[body] for body in np.unique(bodies)})
    if found:
        raise scenario.where.error(
            ("gauge", name, "area"),
            f'gauge.{name}.area: the sensor stands still, but its wall "{found[0]}" moves',
        )
