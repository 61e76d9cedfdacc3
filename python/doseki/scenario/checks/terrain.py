"""Checks of [terrain] against the rest of a scenario."""

from __future__ import annotations

import math

import numpy as np

from ..bed import TILE_COLUMNS
from ..model import Scenario
from ..tables.terrain.release import Release
from ..tables.terrain.terrain import TERRAIN

MAX_TILT = 45.0  # degrees: more is a mistake, less a tilted profile
MAX_COLUMNS = 2**31  # of dp x dp, that particles can number


def check_terrain(scenario: Scenario) -> None:
    """Raise UserError for what a run on a terrain cannot do."""
    if scenario.terrain is None or scenario.bed is None:
        return
    error = scenario.where.error
    for section in ("body", "inflow"):
        if TERRAIN in getattr(scenario, section):
            raise error((section, TERRAIN), f'{section}.{TERRAIN}: the bed has the name "terrain"')
    if scenario.attraction > 0:
        raise error(
            ("attraction",), "attraction pulls towards the origin, and maps have theirs elsewhere"
        )
    _check_gravity(scenario)
    horizontal = set("xyz"[: scenario.dim - 1]) & set(scenario.periodic)
    if horizontal:
        axis = sorted(horizontal)[0]
        raise error(("periodic",), f'periodic: a terrain is not periodic along "{axis}"')
    law = scenario.materials[scenario.terrain.material].law
    if law != "solid":
        raise error(
            ("terrain", "material"),
            f'terrain.material = "{scenario.terrain.material}" is a fluid; a bed is a solid',
        )
    for name, body in scenario.body.items():
        if isinstance(body, Release) and scenario.materials[body.material].law != "fluid":
            raise error(
                ("body", name, "material"),
                f'body.{name}.material = "{body.material}" is a solid; a release flows: take a '
                "fluid, such as one with a yield stress or friction",
            )
    low, high = scenario.bed.extent
    side = TILE_COLUMNS[scenario.dim]
    tiles = np.ceil((high - low) / (side * scenario.dp) + 2)
    columns = float((side * tiles).prod())
    if columns >= MAX_COLUMNS:
        raise error(
            ("dp",),
            f"dp = {scenario.dp:g} m: {columns:.3g} columns of dp cover the terrain; at most "
            f"{MAX_COLUMNS:.3g}: give terrain.window, or increase dp",
        )


def tilt_of(gravity: np.ndarray) -> float:
    """The angle from the downward vertical axis, degrees."""
    return math.degrees(math.atan2(math.hypot(*gravity[:-1]), -gravity[-1]))


def _check_gravity(scenario: Scenario) -> None:
    """Refuse gravity that pulls along a map, or up from it."""
    gravity = scenario.gravity
    if not gravity.any() or tilt_of(gravity) <= MAX_TILT:
        return
    up = "xyz"[scenario.dim - 1]
    size = round(float(np.linalg.norm(gravity)), 9)
    down = [0] * (scenario.dim - 1) + [-size]
    key = "gravity" if "gravity" in scenario.model_fields_set else "slope"
    raise scenario.where.error(
        (key,),
        f"gravity = {gravity.tolist()} is {tilt_of(gravity):.3g} degrees off the downward {up} of "
        f"the terrain; at most {MAX_TILT:g} are allowed, for a tilted profile: on a map set "
        f"gravity = {down}",
    )
