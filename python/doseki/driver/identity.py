"""Which run a checkpoint belongs to."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from ..record.scenario_file import recorded_scenario

# What may change when a run goes on: nothing that the particles or the record were made with.
CHANGEABLE = {
    "time_max", "cflnumber", "cfl_force", "fixed_limits_dt", "alpha", "balsara", "skin", "gravity",
    "title",
}  # fmt: skip


def identity_of(scenario: Path) -> str:
    """A digest of all that scenario.toml of a run keeps, however often the run goes on.

    Of the file rather than of what is made of it: a later version may know more keys.
    """
    table = recorded_scenario(scenario)
    kept = {key: value for key, value in table.items() if key not in CHANGEABLE}
    text = json.dumps(kept, sort_keys=True, default=str)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()
