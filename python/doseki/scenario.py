"""Scenarios: from a TOML file and --set options to a checked description of a run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import PrivateAttr, ValidationError, model_validator

from .hydrograph import complete_inflows
from .materials import Material, MaterialError, complete_materials
from .overrides import apply_overrides
from .particle_file import ParticleTable, read_particles
from .resolve import resolve_table
from .scenario_checks import check_scenario
from .scenario_files import find_scenario, merged_table, read_with_bases, scenario_folder
from .schema import SECTIONS, Mesh, ParticleFile, ScenarioTable
from .schema_errors import to_user_error
from .schemes import KERNEL_SUPPORT, RESOLVED, with_scheme_defaults
from .toml_source import Where, read_toml
from .toml_writer import to_toml


class Scenario(ScenarioTable):
    """A run, checked and without expressions; lengths in m, times in s, angles in degrees.

    The tables of the file are `parameters`, `body`, `inflow`, `outflow`, `gauge`, `window` and
    `figure`, dictionaries by name.  `gravity` is an array (dim,) also where the file gives a
    slope, and `xi` a number also where it gives a height.
    """

    _where: Where = PrivateAttr()
    _materials: dict[str, Material] = PrivateAttr(default_factory=dict)
    _material_names: list[str] = PrivateAttr(default_factory=list)
    _constants: dict[str, Any] = PrivateAttr(default_factory=dict)
    _particle_tables: dict[str, ParticleTable] = PrivateAttr(default_factory=dict)
    _warnings: list[str] = PrivateAttr(default_factory=list)

    @model_validator(mode="after")
    def _fill_defaults(self) -> Scenario:
        if self.gravity is None:
            self.gravity = _gravity_on_slope(self.slope, self.g, self.dim)
        if self.time_history is None:
            self.time_history = self.time_max / 1000
        return self

    @property
    def where(self) -> Where:
        """Names the place of a key in error messages."""
        return self._where

    @property
    def materials(self) -> dict[str, Material]:
        """Every known material by name, with unscaled values."""
        return self._materials

    @property
    def material_names(self) -> list[str]:
        """The materials in use, in order of first use; particles hold indices into this list."""
        return self._material_names

    @property
    def constants(self) -> dict[str, Any]:
        """What expressions may use: the parameters and the top-level numbers."""
        return self._constants

    @property
    def particle_tables(self) -> dict[str, ParticleTable]:
        """What was read for the bodies with shape = "file", by body name."""
        return self._particle_tables

    @property
    def warnings(self) -> list[str]:
        """Sentences about what is allowed but probably not meant."""
        return self._warnings

    @property
    def support(self) -> float:
        """How far a particle of spacing dp acts, m: H h = 2.5 eta dp (Wendland C2: 2 eta dp)."""
        return KERNEL_SUPPORT[self.kernel] * self.eta * self.dp

    def effective_toml(self) -> str:
        """The scenario as TOML that `load_scenario` reads back to the same run."""
        implied = {"xi_height", "speed_max", "slope"}  # xi and gravity say the same
        table = self.model_dump(by_alias=True, exclude_none=True, exclude=implied | set(SECTIONS))
        given = self.model_dump(include=set(SECTIONS), exclude_unset=True)
        given["material"] = {name: asdict(self.materials[name]) for name in self.material_names}
        for material in given["material"].values():
            del material["name"]  # to_toml leaves out what is None
        for name, body in self.body.items():
            if isinstance(body, ParticleFile | Mesh):
                given["body"][name]["file"] = str(_file_of(self, name, body).resolve())
        return to_toml(table | {name: given.get(name, {}) for name in SECTIONS})

    def complete(self, where: Where, constants: dict[str, Any]) -> None:
        """Fill in what follows from the tables together; raises UserError where they disagree."""
        self._where, self._constants = where, constants
        self._materials = _materials(self, where)
        self._particle_tables = {
            name: read_particles(_file_of(self, name, body), self.dim, body.material)
            for name, body in self.body.items()
            if isinstance(body, ParticleFile)
        }
        complete_inflows(self)
        check_scenario(self)
        self._material_names = _materials_in_use(self)
        if self.xi is None:
            self.xi = _reduction_factor(self)


def load_scenario(name_or_path: str, overrides: Sequence[str] = ()) -> Scenario:
    """Read, override, evaluate and check a scenario; raises UserError with one clear sentence."""
    sources = read_with_bases(find_scenario(str(name_or_path)))
    where = Where(sources)
    table = with_scheme_defaults(apply_overrides(merged_table(sources, where), overrides, where))
    table, constants = resolve_table(table, where)
    try:
        scenario = Scenario.model_validate(table, context={"dim": table["dim"]})
    except ValidationError as error:
        raise to_user_error(error, table, where) from None
    scenario.complete(where, constants)
    return scenario


def list_scenarios() -> list[tuple[str, str, Path]]:
    """(name, title, path) of the scenarios that come with doseki."""
    return [
        (path.stem, str(read_toml(path).table.get("title", "")), path)
        for path in sorted(scenario_folder().glob("*.toml"))
    ]


def _file_of(scenario: Scenario, name: str, body: ParticleFile | Mesh) -> Path:
    return scenario.where.folder(("body", name, "file")) / body.file


def _gravity_on_slope(slope: float | None, g: float, dim: int) -> np.ndarray:
    """Gravity along axes aligned with a slope, x pointing up it; zero without a slope."""
    gravity = np.zeros(dim)
    if slope is not None:
        angle = math.radians(slope)
        gravity[0], gravity[-1] = -g * math.sin(angle), -g * math.cos(angle)
    return gravity


def _materials(scenario: Scenario, where: Where) -> dict[str, Material]:
    given = {name: table.model_dump(exclude_none=True) for name, table in scenario.material.items()}
    try:
        return complete_materials(given)
    except MaterialError as error:
        keys = ("material", error.material)
        raise where.error(keys, f"material.{error.material}: {error}") from None


def _materials_in_use(scenario: Scenario) -> list[str]:
    used: list[str] = []
    for name, body in scenario.body.items():
        table = scenario.particle_tables.get(name)
        used += [body.material] if table is None else table.material_names
    used += [inflow.material for inflow in scenario.inflow.values()]
    return list(dict.fromkeys(used))


def _reduction_factor(scenario: Scenario) -> float:
    """xi = 10 sqrt(2 g H)/min c0 over the materials in use (eq. 19); 1 without a height.

    With `speed_max` in place of a height it is 10 speed_max/min c0.
    """
    g = float(np.linalg.norm(scenario.gravity)) or scenario.g
    speed = scenario.speed_max
    if scenario.xi_height is not None:
        speed = math.sqrt(2 * g * scenario.xi_height)
    if speed is None:
        return 1.0
    return 10 * speed / min_sound_speed(scenario)


def min_sound_speed(scenario: Scenario) -> float:
    """Least unscaled sound speed of the materials that limit the speed of the flow, m/s."""
    return min(scenario.materials[name].speedsound for name in _elastic(scenario))


def _elastic(scenario: Scenario) -> list[str]:
    """Materials in use whose sound speed counts: in the resolved scheme walls have none."""
    fluids = [n for n in scenario.material_names if scenario.materials[n].law == "fluid"]
    return fluids if scenario.scheme == RESOLVED and fluids else scenario.material_names
