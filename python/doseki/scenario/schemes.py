"""The schemes: kernels, and the defaults in which they differ."""

from __future__ import annotations

from typing import Any

UETA2022, RESOLVED = "ueta2022", "resolved"
KERNEL_SUPPORT = {"wendland_c2": 2.0, "wendland_c6": 2.5}  # support radius in smoothing lengths
SUPPORT = KERNEL_SUPPORT["wendland_c6"]  # H of the paper: a particle acts out to H h

# What a scenario that does not say so gets; for the paper's scheme these stand in the schema.
RESOLVED_KERNEL, RESOLVED_CFLNUMBER = "wendland_c2", 0.8
RESOLVED_DEFAULTS: dict[str, object] = {
    "kernel": RESOLVED_KERNEL, "cflnumber": RESOLVED_CFLNUMBER, "cfl_force": 0.25,
    "skin": "auto",
}  # fmt: skip
RESOLVED_ETA = {"wendland_c2": 1.39, "wendland_c6": 1.2}


def with_scheme_defaults(table: dict[str, Any]) -> dict[str, Any]:
    """The scenario table with what its scheme takes for granted, so that expressions see it too."""
    if table.get("scheme", UETA2022) != RESOLVED:
        return table
    table = {**RESOLVED_DEFAULTS, **table}
    return {"eta": RESOLVED_ETA.get(table["kernel"], RESOLVED_ETA["wendland_c2"])} | table
