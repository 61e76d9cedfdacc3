"""Inflow sections: where particles enter, how fast, and in which pattern."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .lattice import ROUNDING
from .scenario import Scenario
from .schema import Inflow


@dataclass(frozen=True)
class InflowSection:
    """A plane section through which layers of particles enter, SI units.

    `rows` are the particles of one layer as they cross the section.  Behind it `buffer_layers`
    more layers, `spacing` apart, move with the same `speed`, so that what has entered always has
    neighbours upstream.
    """

    name: str
    material: int  # index into scenario.material_names
    body: int  # index into the body names
    rows: np.ndarray  # (n, dim)
    direction: np.ndarray  # (dim,), unit vector of the flow
    speed: float
    spacing: float
    mass: float  # of each particle, kg (2-D: kg/m)
    density: float
    smoothing_length: float
    start: float
    stop: float
    rate_mass: float  # kg/s (2-D: kg/s/m)
    buffer_layers: int
    jitter: float  # random displacement of a particle, in spacings


def build_inflows(scenario: Scenario, body_names: list[str]) -> list[InflowSection]:
    """The inflow sections; `body_names` are those of `build_bodies`.  Raises UserError."""
    return [_section(scenario, name, body_names.index(name)) for name in scenario.inflow]


def _section(scenario: Scenario, name: str, body: int) -> InflowSection:
    inflow, dp, dim = scenario.inflow[name], scenario.dp, scenario.dim
    material = scenario.materials[inflow.material]
    direction = inflow.direction / np.linalg.norm(inflow.direction)
    rows = _rows(scenario, name, inflow, direction)
    rate = inflow.rate / inflow.width if dim == 2 else inflow.rate
    area = len(rows) * dp ** (dim - 1)
    return InflowSection(
        name=name,
        material=scenario.material_names.index(inflow.material),
        body=body,
        rows=rows,
        direction=direction,
        speed=rate / area,
        spacing=dp,
        mass=material.rho0 * dp**dim,
        density=material.rho0,
        smoothing_length=scenario.eta * dp,
        start=inflow.start,
        stop=inflow.start + inflow.duration,
        rate_mass=material.rho0 * rate,
        buffer_layers=_buffer_layers(scenario),
        jitter=inflow.jitter,
    )


def _rows(scenario: Scenario, name: str, inflow: Inflow, direction: np.ndarray) -> np.ndarray:
    """Centres of the particles of one layer: whole particles along depth and (3-D) width."""
    up, across = section_axes(direction, scenario.gravity)
    dp = scenario.dp
    high = _whole(scenario, name, "depth", inflow.depth)
    steps_up = ((np.arange(high) + 0.5) * dp)[:, None] * up
    if across is None:
        return inflow.position + steps_up
    wide = _whole(scenario, name, "width", inflow.width)
    steps_across = ((np.arange(wide) + 0.5) * dp)[:, None] * across
    layer = steps_up[:, None, :] + steps_across[None, :, :]
    return inflow.position + layer.reshape(-1, 3)


def _whole(scenario: Scenario, name: str, key: str, length: float) -> int:
    """The length in whole particles, at least one."""
    count = round(length / scenario.dp)
    if count < 1:
        raise scenario.where.error(
            ("inflow", name, key),
            f"inflow.{name}.{key} = {length:g} is less than one particle (dp = {scenario.dp:g} m)",
        )
    return count


def section_axes(
    direction: np.ndarray, gravity: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None]:
    """Unit vectors within the section: upwards, and in 3-D across (towards positive axes).

    Upwards is against gravity as far as the section allows, without gravity along the last axis;
    for a vertical flow it is along the first axis.
    """
    last, first = np.eye(len(direction))[[-1, 0]]
    for wish in (-gravity, last, first):
        up = wish - (wish @ direction) * direction
        if np.linalg.norm(up) > 1e-6 * max(np.linalg.norm(wish), 1e-300):
            up /= np.linalg.norm(up)
            break
    if len(direction) == 2:
        return up, None
    across = np.cross(direction, up)
    return up, across * np.sign(across[np.argmax(np.abs(across))])


def _buffer_layers(scenario: Scenario) -> int:
    """Enough that layers appear out of sight of a bed that ends one support before the section.

    A bed that saw particles appear without having come would take them for a steady divergence.
    """
    reach = int(np.ceil(scenario.support / scenario.dp - ROUNDING))
    return 2 * reach + 2
