"""Quantities a picture can show, by name: a field, a component of one, speed, material or body."""

from __future__ import annotations

import numpy as np

from .errors import UserError
from .fields import FIELD_BY_KEY
from .loading import Snapshot
from .measure import speed
from .nearest import suggestion

CATEGORIES = ("material", "body")
_AXES = "xyz"


def quantity_names(dim: int) -> list[str]:
    """Every name that `quantity` knows, and the categories."""
    names = [*CATEGORIES, "speed"]
    for field in FIELD_BY_KEY.values():
        if field.shape == "scalar" and field.key not in CATEGORIES:
            names.append(field.key)
        elif field.shape == "vector":
            names += [f"{field.key}_{axis}" for axis in _AXES[:dim]]
        elif field.shape == "symmetric":
            names += [f"{field.key}_{a}{b}" for a in _AXES for b in _AXES if a <= b]
    return names


def check_quantity(name: str, dim: int) -> None:
    """Raise UserError when there is no quantity of this name."""
    names = quantity_names(dim)
    if name not in names:
        raise UserError(f"colour {name!r} is not something to draw{suggestion(name, names)}")


def quantity(snapshot: Snapshot, name: str) -> np.ndarray:
    """Values (N,) of a quantity that is not a category; raises UserError for an unknown name."""
    check_quantity(name, snapshot.dim)
    if name == "speed":
        return speed(snapshot["velocity"])
    if name in FIELD_BY_KEY:
        return snapshot[name]
    key, _, component = name.rpartition("_")
    axes = tuple(_AXES.index(axis) for axis in component)
    return snapshot[key][:, *axes]


def quantity_label(name: str) -> str:
    """Name and unit in plain text, for a colour bar."""
    key = "velocity" if name == "speed" else name
    field = FIELD_BY_KEY.get(key) or FIELD_BY_KEY[key.rpartition("_")[0]]
    return f"{name.replace('_', ' ')} ({field.unit})" if field.unit else name
