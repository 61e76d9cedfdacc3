"""What came in, went out and is there: mass, energy, and how well the accounts close."""

from __future__ import annotations

import numpy as np

from ...assess.trust.ledger import ledger_of
from ...record.reader import History, Run
from ...record.units import unit_in
from ..markup import Content, Markup, section, table, tag

MASS = {
    "mass_initial": "at the start",
    "mass_entered": "entered",
    "mass_left": "left",
    "mass_inside": "inside at the end",
}
HELD = {
    "kinetic_energy": "kinetic",
    "bulk_energy": "elastic, bulk",
    "shear_energy": "elastic, shear",
    "elastic_energy": "elastic, of deformable bodies",
}
FLOWS = {
    "av_dissipation": "dissipated (viscosity, eddies, walls)",
    "gravity_work": "work of gravity",
    "wall_work": "work of walls and inflow layers",
    "contact_work": "work of contacts",
    "scheme_work": "made by corrections of the scheme",
    "relaxation_work": "of that by the relaxation of density",
    "fracture_work": "taken by cracks",
    "parting_work": "lost when parts came off",
    "damping_work": "taken by dampers of deformable bodies",
    "energy_entered": "carried in",
    "energy_left": "carried out",
}


def ledgers(run: Run) -> Markup | None:
    """The section of the ledgers."""
    history = run.history
    if "time" not in history or not len(history["time"]):
        return None
    dim = run.scenario["dim"]
    mass, energy = _mass(history, unit_in("kg", dim)), _energy(run, unit_in("J", dim))
    return section("Ledgers", tag("div", mass, energy, class_="columns"), name="ledgers")


def _mass(history: History, unit: str) -> Content:
    if not set(MASS) <= set(history):
        return None
    last = {name: float(history[name][-1]) for name in MASS}
    rest = last["mass_initial"] + last["mass_entered"] - last["mass_left"] - last["mass_inside"]
    rows = [(text, f"{last[name]:.6g}") for name, text in MASS.items()]
    rows.append(("start + entered - left - inside", f"{rest:.2g}"))
    return table(["mass", unit], rows)


def _energy(run: Run, unit: str) -> Content:
    """Each energy at the start and at the end; works and flows since the start."""
    history = run.history
    there = [name for name in HELD if name in history]
    if not there:
        return None
    rows = [(HELD[name], *(f"{history[name][k]:.4g}" for k in (0, -1))) for name in there]
    for name, text in FLOWS.items():
        if name in history and np.any(history[name]):
            rows.append((text, "", f"{history[name][-1]:.4g}"))
    ledger = ledger_of(run)
    if ledger is not None and not ledger.unknown:
        residual = ledger.energy_residual()[-1]
        rows.append(("what the account leaves open", "", f"{residual:.2g}"))
    return table([f"energy ({unit})", "start", "end"], rows)
