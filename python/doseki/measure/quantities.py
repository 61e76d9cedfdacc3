"""Values of the quantities that a picture can show."""

from __future__ import annotations

import numpy as np

from ..record.fields import FIELD_BY_KEY
from ..record.quantities import AXES, check_quantity
from ..record.reader import Snapshot
from .numbers import speed


def quantity(snapshot: Snapshot, name: str) -> np.ndarray:
    """Values (N,) of a quantity that is not a category; raises UserError for an unknown name."""
    check_quantity(name, snapshot.dim)
    if name == "speed":
        return speed(snapshot["velocity"])
    if name in FIELD_BY_KEY:
        return snapshot[name]
    key, _, component = name.rpartition("_")
    values = snapshot[key]
    for axis in component:
        values = values[:, AXES.index(axis)]
    return values
