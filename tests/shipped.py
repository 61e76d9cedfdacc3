"""The scenarios that come with doseki, and the dimensions in which each can be run."""

from __future__ import annotations

from doseki.scenario.load import list_scenarios

NAMES = [name for name, _, _ in list_scenarios()]
# A map is of three dimensions, a profile of two; those of the gallery are made for one.
ONLY = {
    "valley": 3, "slit-dam": 3, "gate-release": 2, "gate-release-3d": 3, "drip": 2, "dam-step": 2,
    "drum": 2, "elastic-gate": 2, "flood-log": 2, "segregation": 2, "slide-wave": 2,
    "flume-3d": 3, "flume-strip": 3,
    "brazil-test": 2, "breaking-flume": 2, "drop-weight": 2,
}  # fmt: skip
CASES = [(name, dim) for name in NAMES for dim in (2, 3) if ONLY.get(name, dim) == dim]
FIRST = [(name, ONLY.get(name, 2)) for name in NAMES]
# Settings for tests of a scenario that is too large at the spacing that it is shipped with.
PARTS = {
    "flume-3d": [
        "dp=0.005", "flume_length=0.8", "load_start=0.4", "load_mass=0.5", "load_length=0.126",
        "load_packing=0.4", "width=0.05", "wall_height=0.03", "board_length=0.1", "board_width=0.1",
    ],
    "gate-release-3d": ["dp=0.3"],
}  # fmt: skip
