"""Where fluid met a side of a fixed body that is no wall, since its `normal` says so."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...record.particles import FIXED, FREE
from ...record.reader import Run, Snapshot
from ...scenario.load import load_scenario
from ...scenario.model import Scenario
from ...scene.kinds.registry import bodies_of
from ...scene.kinds.shaped import Shaped
from ...scene.moved import Displacement
from .verdicts import Check, judged

BESIDE = (0.02, 0.2)  # share of the fluid that touches a body
NEAR = 1.2  # spacings: fluid that touches a wall is nearer to its particles
BELOW = 1.0  # spacings below the face, where fluid is beside the body and not on it
NAMED = 3  # bodies that a finding names


def faces_check(run: Run) -> list[Check]:
    """How much of the fluid at bodies of one face was beside it, and which; nothing without any.

    A `normal` gives a body that one plane face: what fluid does to its other sides is not right.
    """
    if not any("normal" in body for body in run.scenario.get("body", {}).values()):
        return []
    scenario = load_scenario(run.folder.scenario)
    normals = dict(_normals(scenario))
    worst = dict.fromkeys(normals, 0.0)
    for snapshot in run:
        fluid = snapshot["position"][snapshot["motion"] == FREE]
        for name, share in _beside(scenario, snapshot, fluid, normals).items():
            worst[name] = max(worst[name], share)
    bodies = sorted(filter(worst.get, worst), key=worst.__getitem__, reverse=True)
    counted = f"share of the fluid that touches a body, the most of {len(run)} snapshots"
    remedy = (
        f"at {', '.join(bodies[:NAMED])}: a `normal` gives a body one face; leave it out, so that"
        " all of its sides are walls"
    )
    value = max(worst.values(), default=0.0)
    return [judged("fluid at sides without a face", value, BESIDE, counted, remedy)]


def _normals(scenario: Scenario) -> Iterator[tuple[str, np.ndarray]]:
    """Those that fixed bodies of the scenario say themselves, before their motions."""
    for name, body in bodies_of(scenario).items():
        table = scenario.body[name]
        given, carved = table.given("normal"), table.given("where") is not None
        if isinstance(body, Shaped) and table.fixed and given is not None and not carved:
            yield name, body.rotation @ (np.asarray(given, float) / np.linalg.norm(given))


def _beside(
    scenario: Scenario, snapshot: Snapshot, fluid: np.ndarray, normals: dict[str, np.ndarray]
) -> dict[str, float]:
    """Of the fluid that touches each of these bodies, the share below its face."""
    from scipy.spatial import cKDTree

    position, names = snapshot["position"], np.asarray(snapshot["body"])
    is_wall, near = snapshot["motion"] == FIXED, NEAR * scenario.dp
    found = {}
    for name, normal in normals.items():
        of_it = is_wall & np.isin(names, scenario.names_of_bodies(name))
        if not of_it.any():
            continue
        own = position[of_it]
        low, high = own.min(axis=0) - near, own.max(axis=0) + near
        beside = fluid[((fluid > low) & (fluid < high)).all(axis=1)]
        if not len(beside):
            continue
        walls = is_wall & ((position > low - near) & (position < high + near)).all(axis=1)
        apart, nearest = cKDTree(position[walls]).query(beside, distance_upper_bound=near)
        at_it = np.append(of_it[walls], False)[nearest] & np.isfinite(apart)
        if at_it.any():
            now = Displacement(scenario, name, snapshot.time).vectors(normal[None])[0]
            surface = (own @ now).max() + 0.5 * scenario.dp
            below = beside[at_it] @ now < surface - BELOW * scenario.dp
            found[name] = float(below.mean())
    return found
