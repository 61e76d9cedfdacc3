"""The quantities that a picture can show, by name: a field, a component of one, speed, a category.

A component of a vector is named `velocity_x`, one of a tensor `stress_xy`.
"""

from __future__ import annotations

from ..errors import UserError
from ..util.spelling import suggestion
from .fields import FIELD_BY_KEY

CATEGORIES = ("material", "body")
AXES = "xyz"


def quantity_names(dim: int) -> list[str]:
    """The names of all quantities of a run of `dim` dimensions, the categories included."""
    names = [*CATEGORIES, "speed"]
    for field in FIELD_BY_KEY.values():
        if field.shape == "scalar" and field.key not in CATEGORIES:
            names.append(field.key)
        elif field.shape == "vector":
            names += [f"{field.key}_{axis}" for axis in AXES[:dim]]
        elif field.shape == "symmetric":
            names += [f"{field.key}_{a}{b}" for a in AXES for b in AXES if a <= b]
    return names


def check_quantity(name: str, dim: int) -> None:
    """Raise UserError when there is no quantity of this name."""
    names = quantity_names(dim)
    if name not in names:
        raise UserError(f"colour {name!r} is not something to draw{suggestion(name, names)}")


def quantity_label(name: str, dim: int) -> str:
    """Name and unit in plain text, for a colour bar of a run of `dim` dimensions."""
    key = "velocity" if name == "speed" else name
    field = FIELD_BY_KEY.get(key) or FIELD_BY_KEY[key.rpartition("_")[0]]
    unit = field.unit_in(dim)
    return f"{name.replace('_', ' ')} ({unit})" if unit else name
