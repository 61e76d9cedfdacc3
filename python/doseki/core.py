"""The compiled core: which instruction set runs, and a simulation made from a scenario."""

from __future__ import annotations

import os
import platform
from dataclasses import asdict
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from .bodies import build_bodies
from .errors import UserError
from .inflows import InflowSection, build_inflows
from .scenario import Scenario

# What a module was compiled for, and the processor flags that must be there for it.
INSTRUCTION_SETS = {
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "v3": {"avx2", "fma", "bmi1", "bmi2", "f16c"},
    "native": set(),
    "scalar": set(),
}


def _processor_flags() -> set[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return set()
    return next((set(line.split()) for line in lines if line.startswith("flags")), set())


def available_instruction_sets() -> list[str]:
    """Instruction sets that were built and that this processor has, fastest first."""
    flags = _processor_flags()
    return [
        isa
        for isa, needed in INSTRUCTION_SETS.items()
        if needed <= flags and find_spec(f"doseki._core_{isa}") is not None
    ]


@cache
def load_core(isa: str | None = None) -> ModuleType:
    """The extension module for an instruction set.

    `isa` is "v4" (AVX-512), "v3" (AVX2), "native" (other processors) or "scalar" (one lane, the
    reference); by default the environment variable DOSEKI_ISA, else the fastest one available.
    Raises UserError when it is not available here.
    """
    available = available_instruction_sets()
    chosen = isa or os.environ.get("DOSEKI_ISA") or (available[0] if available else None)
    if chosen not in available:
        raise UserError(
            f"instruction set {chosen!r} is not available on this {platform.machine()} processor;"
            f" built and usable here: {', '.join(available) or 'none (is the core built?)'}"
        )
    return import_module(f"doseki._core_{chosen}")


def core_options(scenario: Scenario) -> dict[str, Any]:
    """The parameters of the scheme, as the core reads them."""
    names = "eta alpha cflnumber cfl_force skin balsara sym_grad tension h_mode".split()
    axes = "xyz"[: scenario.dim]
    zeros = [0.0] * scenario.dim
    low, high = scenario.domain_min, scenario.domain_max
    return {name: getattr(scenario, name) for name in names} | {
        "gravity": list(scenario.gravity),
        "periodic": [axis in scenario.periodic for axis in axes],
        "domain_min": zeros if low is None else list(low),
        "domain_max": zeros if high is None else list(high),
    }


def core_materials(scenario: Scenario) -> list[dict[str, Any]]:
    """Materials in the order of their indices, scaled by xi; without strength, mu = 0."""
    tables = []
    for name in scenario.material_names:
        table = asdict(scenario.materials[name].scaled(scenario.xi))
        if not scenario.strength:
            table["shear_modulus"] = 0.0
        tables.append(table)
    return tables


def _inflow_table(section: InflowSection) -> dict[str, Any]:
    return {
        "layer": [list(row) for row in section.rows],
        "direction": list(section.direction),
        **{
            name: getattr(section, name)
            for name in "speed spacing mass density smoothing_length start stop".split()
        },
        "buffer_layers": int(section.buffer_layers),
        "material": int(section.material),
        "body": int(section.body),
    }


def build_simulation(scenario: Scenario, isa: str | None = None) -> tuple[Any, list[str]]:
    """A started core simulation of `scenario`, and the names of its bodies."""
    core = load_core(isa)
    particles, body_names = build_bodies(scenario)
    kind = getattr(core, f"Simulation{scenario.dim}{scenario.precision.capitalize()}")
    simulation = kind(core_materials(scenario), core_options(scenario))
    simulation.add_particles(**{name: np.ascontiguousarray(v) for name, v in vars(particles).items()})
    for section in build_inflows(scenario, body_names):
        simulation.add_inflow(_inflow_table(section))
    for outflow in scenario.outflow.values():
        simulation.add_outflow(list(outflow.min), list(outflow.max))
    simulation.start()
    return simulation, body_names
