"""Dry blocks and balls of one material, for tests of how they touch."""

from __future__ import annotations

from typing import Any

import numpy as np

from doseki.solver.build import empty_simulation
from doseki.solver.restoring import check_state
from doseki.validate.running import FOREVER, Running

HEAD = """
dim = {dim}
scheme = "resolved"
speed_max = {speed}
dp = {dp}
time_max = {time}
time_out = {time}
gravity = {gravity}

[contact]
law = "{law}"

[material.stone]
based_on = "basalt"
rho0 = 2000
restitution = {restitution}
friction = {friction}
"""


def head(gravity: Any, dp: float, **values: Any) -> str:
    """What stands above the bodies; the dimension is that of gravity."""
    given = {"speed": 1, "time": 1, "law": "linear", "restitution": 0.2, "friction": 0.3, **values}
    return HEAD.format(dim=len(gravity), dp=dp, gravity=listed(gravity), **given)


def box(name: str, low: Any, high: Any, *, fixed: bool = False, **values: Any) -> str:
    """A box from `low` to `high`; with `rotate`, about its middle."""
    given = {"min": listed(low), "max": listed(high), **values}
    if "rotate" in given:
        given.setdefault("pivot", listed((np.array(low) + np.array(high)) / 2))
    return body(name, "box", fixed=fixed, **given)


def ball(name: str, centre: Any, radius: float, **values: Any) -> str:
    """A disc or a sphere."""
    shape = "disc" if len(centre) == 2 else "sphere"
    return body(name, shape, centre=listed(centre), radius=radius, **values)


def body(name: str, shape: str, *, fixed: bool = False, **values: Any) -> str:
    """A table of a scenario."""
    rows = {"shape": f'"{shape}"', "material": '"stone"', "fixed": str(fixed).lower(), **values}
    return f"\n[body.{name}]\n" + "".join(f"{key} = {value}\n" for key, value in rows.items())


def listed(values: Any) -> list[float]:
    """As a scenario has it."""
    return [float(value) for value in values]


def started(folder: Any, text: str) -> Running:
    """The scenario of this text."""
    path = folder / "blocks.toml"
    path.write_text(text)
    return Running(str(path))


def moving(run: Running, field: str) -> np.ndarray:
    """A field of the bodies that move, in the order of the scenario."""
    grains = run.grains()
    return np.array(grains[field][~grains["fixed"]])


def assert_restored_with_the_same_bits(run: Running, moving_bodies: int, until: float) -> None:
    """A 2-D run goes on as another one does that is restored from where it is."""
    saved = run.simulation.checkpoint()
    other = empty_simulation(run.scenario, run.body_names)
    check_state(other, saved, moving_bodies, len(run.body_names))
    assert other.restore(saved)
    for one in (run.simulation, other):
        one.advance(limit=until, pause=until, max_steps=FOREVER)
    for key, values in run.simulation.grains().items():
        assert np.array_equal(values, other.grains()[key]), key
