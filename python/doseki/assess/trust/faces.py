"""Where fluid met a side of a fixed body that is no wall, since its `normal` says so."""

from __future__ import annotations

from collections import Counter
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

BESIDE = (0.001, 0.02)  # share of the fluid
NEAR = 1.2  # spacings: fluid that touches a wall is nearer to its particles
BELOW = 1.0  # spacings below the face, where fluid is beside the body and not on it
NAMED = 3  # bodies that a finding names


def faces_check(run: Run) -> list[Check]:
    """How much of the fluid was beside bodies of one face, and which; nothing without any.

    A `normal` gives a body that one plane face: what fluid does to its other sides is not right.
    """
    if not any("normal" in body for body in run.scenario["body"].values()):
        return []
    scenario = load_scenario(run.folder.scenario)
    normals = dict(_normals(scenario))
    shares, of_bodies = [0.0], Counter[str]()
    for snapshot in run:
        fluid = snapshot["motion"] == FREE
        beside = _beside(scenario, snapshot, snapshot["position"][fluid], normals)
        shares.append(sum(beside.values()) / max(int(fluid.sum()), 1))
        of_bodies.update(beside)
    worst = [name for name, count in of_bodies.most_common(NAMED) if count]
    counted = f"share of the fluid in {len(shares) - 1} snapshots"
    remedy = (
        f"at {', '.join(worst)}: a `normal` gives a body one face; leave it out, so that"
        " all of its sides are walls"
    )
    return [judged("fluid at sides without a face", max(shares), BESIDE, counted, remedy)]


def _normals(scenario: Scenario) -> Iterator[tuple[str, np.ndarray]]:
    """Those that fixed bodies of the scenario say themselves, before their motions."""
    for name, body in bodies_of(scenario).items():
        if isinstance(body, Shaped) and body.table.fixed and body.table.normal is not None:
            given = np.asarray(body.table.normal, float)
            yield name, body.rotation @ (given / np.linalg.norm(given))


def _beside(
    scenario: Scenario, snapshot: Snapshot, fluid: np.ndarray, normals: dict[str, np.ndarray]
) -> dict[str, int]:
    """How many particles of fluid touch each of these bodies below its face."""
    from scipy.spatial import cKDTree

    position, names = snapshot["position"], np.asarray(snapshot["body"])
    walls = np.flatnonzero(snapshot["motion"] == FIXED)
    if not len(walls) or not len(fluid):
        return {}
    tree = cKDTree(position[walls])
    nearest = tree.query(fluid, distance_upper_bound=NEAR * scenario.dp)[1]
    touched = np.append(names[walls], "")[nearest]  # the last: of those that touch none
    found = {}
    for name, normal in normals.items():
        own = scenario.names_of_bodies(name)
        of_it = np.isin(names[walls], own)
        if not of_it.any():
            continue
        now = Displacement(scenario, name, snapshot.time).vectors(normal[None])[0]
        surface = (position[walls[of_it]] @ now).max() + 0.5 * scenario.dp
        below = fluid @ now < surface - BELOW * scenario.dp
        found[name] = int(np.count_nonzero(below & np.isin(touched, own)))
    return found
