"""The columns of history.csv (units: docs/output.md)."""

from __future__ import annotations

from collections.abc import Sequence

from .units import unit_in

BODY_ENERGIES = ("elastic_energy", "fracture_work", "parting_work", "damping_work")
BROKEN = ("broken_bonds", "parts", "dust_grains")
SHARES = ("balance", "migrate", "halo", "wait")  # of the wall time, beside the steps themselves


def history_columns(dim: int, material_names: Sequence[str]) -> list[str]:
    """Names of the columns, in order."""
    momentum = [f"momentum_{axis}" for axis in "xyz"[:dim]]
    energies = ["kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation"]
    work = ["gravity_work", "wall_work", "contact_work", "scheme_work", "relaxation_work"]
    bodies = [*BODY_ENERGIES, *BROKEN]
    carried = ["energy_entered", "energy_left"]
    for name in ("impulse", "momentum_entered", "momentum_left"):
        carried += [f"{name}_{axis}" for axis in "xyz"[:dim]]
    masses = ["mass_asked", "mass_entered", "mass_left", "mass_inside", "mass_initial"]
    counts = ["n_particles", *(f"n_{name}" for name in material_names)]
    ranks = ["imbalance", *(f"share_{name}" for name in SHARES)]
    start = ["time", "step", "dt", "mass", *momentum, *energies]
    return [*start, *work, *bodies, *carried, *masses, *counts, *ranks]


# How names of columns begin or end, and the unit in 3-D of what they hold.
UNITS = {
    "time": "s",
    "dt": "s",
    "mass": "kg",
    "momentum": "kg m/s",
    "impulse": "kg m/s",
    "energy": "J",
    "work": "J",
    "dissipation": "J",
}


def history_units(columns: Sequence[str]) -> dict[str, str]:
    """Units of columns of a history by name."""
    dim = 3 if "momentum_z" in columns else 2
    return {column: history_unit(column, dim) for column in columns}


def history_unit(column: str, dim: int) -> str:
    """The unit of a column in a run of `dim` dimensions; "" for counts and shares."""
    if column.startswith(("n_", "share_")):
        return ""
    words = column.split("_")
    return unit_in(UNITS.get(words[0]) or UNITS.get(words[-1], ""), dim)
