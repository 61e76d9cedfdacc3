"""Units of quantities of a whole run: in 2-D they are per metre of thickness."""

from __future__ import annotations

PER_METRE = {
    "kg": "kg/m",
    "kg/s": "kg/s/m",
    "kg m/s": "kg/s",
    "m3/s": "m2/s",
    "m3": "m2",
    "J": "J/m",
    "N": "N/m",
    "N m": "N",
}


def unit_in(unit: str, dim: int) -> str:
    """The unit in a run of `dim` dimensions of what has `unit` in 3-D and adds up over a run."""
    return PER_METRE.get(unit, unit) if dim == 2 else unit
