"""A tank: walls outside a box."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..schemes import KERNEL_SUPPORT
from ..tables.bodies import Tank
from ..tables.root import ScenarioTable
from ..tables.wall import FRICTION_OF

Part = dict[str, Any]
# Keys that each wall takes over.
OF_BOX = ("material", "motion", "wall", *FRICTION_OF, "enabled")


def walls_of_tank(table: dict[str, Any], name: str, part: Part) -> dict[str, Part]:
    """Fixed boxes NAME.-x, NAME.+x ... around the inner box, which leave no gaps in the corners.

    `table` is the scenario.  Raises pydantic's ValidationError, and ValueError.
    """
    tank = Tank.model_validate(part, context={"dim": table["dim"]})
    dim, low, high = table["dim"], tank.min, tank.max
    sides = [f"{sign}{axis}" for axis in "xyz"[:dim] for sign in "-+"]
    opens = [f"+{'xyz'[dim - 1]}"] if tank.open is None else tank.open
    unknown = sorted(set(opens) - set(sides))
    if unknown:
        raise ValueError(f'a {dim}-D tank has no side "{unknown[0]}"')
    thickness = _thickness(table) if tank.thickness is None else tank.thickness
    given = {key: part[key] for key in OF_BOX if key in part}
    # The floor reaches below the walls, and each wall before the next ones.
    outer = [
        low - [thickness if f"-{axis}" not in opens else 0.0 for axis in "xyz"[:dim]],
        high + [thickness if f"+{axis}" not in opens else 0.0 for axis in "xyz"[:dim]],
    ]
    reach = [end.copy() for end in outer]
    walls = {}
    for axis in reversed(range(dim)):
        for sign, end, inner in (("-", 0, low), ("+", 1, high)):
            side = f"{sign}{'xyz'[axis]}"
            if side in opens:
                continue
            corners = [reach[0].copy(), reach[1].copy()]
            corners[1 - end][axis], corners[end][axis] = inner[axis], outer[end][axis]
            normal = np.zeros(dim)
            normal[axis] = 1.0 if sign == "-" else -1.0
            walls[f"{name}.{side}"] = given | {
                "shape": "box",
                "fixed": True,
                "min": corners[0].tolist(),
                "max": corners[1].tolist(),
                "normal": normal.tolist(),
            }
        reach[0][axis], reach[1][axis] = low[axis], high[axis]
    if table.get("scheme") != "resolved":
        for wall in walls.values():
            del wall["normal"]
    return walls


def _thickness(table: dict[str, Any]) -> float:
    """As many layers as the kernel sees, m.

    Any, where one of the keys that say so is wrong: the tank is not to blame, and the reading of
    the whole scenario refuses that key.
    """
    fields = ScenarioTable.model_fields
    kernel, eta, dp = (table.get(key, fields[key].default) for key in ("kernel", "eta", "dp"))
    try:
        return math.ceil(KERNEL_SUPPORT[kernel] * eta - 0.5 - 1e-9) * float(dp)
    except (KeyError, TypeError, ValueError, OverflowError):
        return 1.0
