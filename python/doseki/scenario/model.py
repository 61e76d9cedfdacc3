"""A scenario that has been read and checked: the description of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ConfigDict, PrivateAttr

from ..record.folder import INPUTS
from ..util.finding import Finding
from ..util.frozen import frozen
from ..util.input_file import InputFile, input_file
from ..util.toml_writer import to_toml
from .bed import Bed
from .earlier import Earlier
from .gauges.gauge import Gauge, Setting
from .gauges.loads.metered import Metered
from .gauges.loads.overtopping import Overtopping
from .kinematics import Kinematics
from .materials import MATERIAL_PARAMETERS, Material, fracture_keys
from .named_files import NamedFile, named_files
from .particle_files.reader import ParticleTable
from .schemes import KERNEL_SUPPORT, RESOLVED
from .table import Table
from .tables.root import ScenarioTable
from .tables.sections import SECTIONS
from .tables.terrain.terrain import TERRAIN, Terrain
from .values.toml_source import Where
from .values.types import Acceleration, Duration, Positive


@dataclass(frozen=True)
class Found:
    """What was read and worked out for a scenario beside its tables."""

    constants: Mapping[str, Any]
    particle_tables: Mapping[str, ParticleTable]
    earlier: Earlier | None = None
    bed: Bed | None = None
    findings: Sequence[Finding] = ()
    taken_in: Sequence[InputFile] = ()  # files of which the tables hold all that is needed


class Scenario(ScenarioTable):
    """A run, checked and without expressions; lengths in m, times in s, angles in degrees.

    The tables of the file are `parameters`, `body`, `inflow`, `outflow`, `gauge`, `window` and
    `figure`, dictionaries by name.  `gravity` is an array (dim,) also where the file gives a
    slope, and `xi` a number also where it gives a height.  Nothing of it changes once it is made,
    nor do its dictionaries; `with_xi` makes another one.
    """

    model_config = ConfigDict(frozen=True)

    gravity: Acceleration
    time_history: Duration
    xi: Positive

    _where: Where = PrivateAttr()
    _materials: Mapping[str, Material] = PrivateAttr()
    _constants: Mapping[str, Any] = PrivateAttr()
    _particle_tables: Mapping[str, ParticleTable] = PrivateAttr()
    _earlier: Earlier | None = PrivateAttr(None)
    _bed: Bed | None = PrivateAttr(None)
    _findings: Sequence[Finding] = PrivateAttr(())
    _taken_in: Sequence[InputFile] = PrivateAttr(())

    @classmethod
    def made_of(
        cls,
        tables: ScenarioTable,
        completed: Mapping[str, Any],
        where: Where,
        materials: Mapping[str, Material],
        found: Found,
    ) -> Scenario:
        """The scenario of checked `tables`, with the values `completed` that follow from them."""
        fields = ScenarioTable.model_fields.items()
        values = {field.alias or name: getattr(tables, name) for name, field in fields}
        values |= completed
        made = cls.model_construct(
            tables.model_fields_set, **{name: frozen(value) for name, value in values.items()}
        )
        made._where, made._materials = where, frozen(materials)
        made._constants = frozen(found.constants)
        made._particle_tables = frozen(found.particle_tables)
        made._earlier, made._bed = found.earlier, found.bed
        made._findings, made._taken_in = tuple(found.findings), tuple(found.taken_in)
        return made

    def forget_heights(self) -> None:
        """Let go of the map, of which another rank gives the parts that are needed."""
        self._bed = None if self._bed is None else self._bed.without_heights()

    @property
    def where(self) -> Where:
        """Names the place of a key in error messages."""
        return self._where

    @property
    def materials(self) -> Mapping[str, Material]:
        """Every known material by name, with unscaled values."""
        return self._materials

    @cached_property
    def material_names(self) -> list[str]:
        """The materials in use, in order of first use; particles hold indices into this list."""
        return names_in_use(self, self._particle_tables)

    @property
    def liquids(self) -> list[str]:
        """Those of them that are fluids."""
        return [name for name in self.material_names if self.materials[name].law == "fluid"]

    @property
    def constants(self) -> Mapping[str, Any]:
        """What expressions may use: the parameters and the top-level numbers."""
        return self._constants

    @property
    def particle_tables(self) -> Mapping[str, ParticleTable]:
        """What was read for the bodies with shape = "file", by body name."""
        return self._particle_tables

    @property
    def earlier(self) -> Earlier | None:
        """The run that it starts from, if it does."""
        return self._earlier

    @property
    def findings(self) -> Sequence[Finding]:
        """What is doubtful about the files that it was read from."""
        return self._findings

    @property
    def walls(self) -> dict[tuple[str, ...], Table]:
        """The tables that may say how fluid meets something, by where they stand."""
        bodies: dict[tuple[str, ...], Table] = {
            ("body", name): body for name, body in self.body.items()
        }
        return bodies if self.terrain is None else bodies | {(TERRAIN,): self.terrain}

    @property
    def bed(self) -> Bed | None:
        """The ground of [terrain], where there is one."""
        return self._bed

    @property
    def begins_at(self) -> float:
        """Time at which the clock starts, s."""
        return 0.0 if self._earlier is None else self._earlier.time

    @cached_property
    def carried(self) -> frozenset[str]:
        """The tables [body.NAME] whose particles and bodies come from the earlier run."""
        if self._earlier is None:
            return frozenset()
        return frozenset(self.body) & frozenset(self._earlier.section("body"))

    @property
    def support(self) -> float:
        """How far a particle of spacing dp acts, m: H h = 2.5 eta dp (Wendland C2: 2 eta dp)."""
        return KERNEL_SUPPORT[self.kernel] * self.eta * self.dp

    def smoothing_length(self, mass: np.ndarray, density: np.ndarray) -> np.ndarray:
        """h = eta (m/rho)^(1/dim) (eq. 10), m, of particles (N,)."""
        return self.eta * (mass / density) ** (1 / self.dim)

    @property
    def min_sound_speed(self) -> float:
        """Smallest unscaled sound speed of the materials that limit the speed of the flow, m/s."""
        return min_sound_speed(self, self.materials, self.material_names)

    @property
    def steps_of_contact(self) -> int:
        """Time steps in a contact: more where its force decides whether a body breaks."""
        breaks = any(body.given("kinematics") == "breakable" for body in self.body.values())
        return self.contact.steps or (20 if breaks else 12)

    @property
    def pore_pressure_ratios(self) -> dict[float, str]:
        """Every pore pressure ratio that fluids in use have, with the first fluid that has it."""
        found: dict[float, str] = {}
        for name in self.liquids:
            found.setdefault(self.materials[name].of_laws["pore_pressure_ratio"], name)
        return found

    @property
    def is_dry(self) -> bool:
        """Whether it has no fluid at all."""
        return not self.liquids

    @property
    def acoustic_timestep(self) -> float:
        """What sound allows a step at most, s (Eqs. 18 and 41)."""
        return self.cflnumber * self.eta * self.dp / (self.xi * self.min_sound_speed)

    def kinematics_of(self, name: str) -> Kinematics:
        """How the particles of [body.NAME] move."""
        body = self.body[name]
        law = self.materials[body.material].law if body.material is not None else None
        return body.kinematics_in(self.scheme, law)

    def names_of_bodies(self, name: str) -> list[str]:
        """The bodies that [body.NAME] stands for: a file may have names of its own."""
        read = self.particle_tables.get(name)
        return [name] if read is None or read.body is None else list(read.body_names)

    def interval_of(self, gauge: Gauge) -> float:
        """Time between two samples, s."""
        return self.time_out if gauge.interval is None else gauge.interval

    @property
    def sound_speed_key(self) -> tuple[str, float]:
        """The key by which the file gives the reduced sound speed, and its value."""
        for key in ("speed_max", "xi_height"):
            value = getattr(self, key)
            if value is not None:
                return key, value
        return "xi", self.xi

    @property
    def sampled_intervals(self) -> list[float]:
        """Times between the outputs at which a step ends exactly, s: snapshots, gauges and maps."""
        maps = [] if self.maps is None else [self.maps.interval or self.time_out]
        return [self.time_out, *(self.interval_of(gauge) for gauge in self.gauge.values()), *maps]

    @property
    def has_bodies_alone(self) -> bool:
        """Whether all that moves are bodies as a whole: no particle has an equation of state."""
        return self.is_dry and self.scheme == RESOLVED

    @property
    def rows_end_steps(self) -> bool:
        """Whether steps end at rows of the history: these are asked for, and steps may be long."""
        return self.has_bodies_alone and "time_history" in self.model_fields_set

    def setting(self, body_names: Sequence[str] = ()) -> Setting:
        """What surrounds its gauges; `body_names` are those that particles index."""
        low, high = self.domain_min, self.domain_max
        domain = None
        if low is not None and high is not None and np.all(low < high):
            domain = low, high
        return Setting(
            dim=self.dim,
            dp=self.dp,
            timestep=self.acoustic_timestep,
            scheme=self.scheme,
            gravity=self.gravity,
            periodic=tuple("xyz".index(axis) for axis in self.periodic),
            domain=domain,
            fixed={name: body.fixed for name, body in self.body.items()},
            kinematics={name: self.kinematics_of(name).name for name in self.body},
            material_names=self.material_names,
            body_names=body_names,
            named={name: self.names_of_bodies(name) for name in self.body},
            support=self.support,
            has_bodies_alone=self.has_bodies_alone,
            moving=frozenset(name for name, body in self.body.items() if body.prescribed_motion),
        )

    @property
    def metered(self) -> list[str]:
        """The gauges that have load meters of the core, in the order of these."""
        return [name for name, gauge in self.gauge.items() if isinstance(gauge, Metered)]

    @property
    def crossed(self) -> list[str]:
        """The gauges whose planes the core counts at, in the order of these."""
        return [name for name, gauge in self.gauge.items() if isinstance(gauge, Overtopping)]

    def ends_of(self, axis: int) -> tuple[float, float]:
        """Lower and upper end of the domain along an axis that has them, m."""
        assert self.domain_min is not None
        assert self.domain_max is not None
        return float(self.domain_min[axis]), float(self.domain_max[axis])

    def with_xi(self, xi: float) -> Scenario:
        """The same run with another reduction factor, whatever it follows from in the file."""
        return self.model_copy(update={"xi": xi, "xi_height": None, "speed_max": None})

    @property
    def inputs(self) -> list[InputFile]:
        """The files that it needs; raises UserError for one that cannot be read."""
        of_terrain = [] if self.terrain_input is None else [self.terrain_input]
        return [*self.body_files.values(), *of_terrain, *self.start_files]

    @property
    def named_files(self) -> list[NamedFile]:
        """Every file that was read for it, those that it no longer needs among them.

        Raises UserError for one that cannot be read.
        """
        known = {file.path: file for file in [*self._taken_in, *self.inputs]}
        named = dict(self.where.named)
        if self.start_files:
            named["start", "from"] = [file.path for file in self.start_files]
        return named_files(named, known)

    @cached_property
    def terrain_input(self) -> InputFile | None:
        """That of [terrain]."""
        return None if self.terrain is None else input_file(terrain_file(self.where, self.terrain))

    @cached_property
    def body_files(self) -> dict[str, InputFile]:
        """Those that bodies name, by body."""
        given = ((name, body.given("file")) for name, body in self.body.items())
        files = {name: file_of(self.where, name, file) for name, file in given if file is not None}
        return {name: input_file(path) for name, path in files.items()}

    @cached_property
    def start_files(self) -> list[InputFile]:
        """Those of the run that it starts from."""
        return [] if self._earlier is None else [input_file(p) for p in self._earlier.files]

    def effective_toml(self, stored: bool = False) -> str:
        """The scenario as TOML that `load_scenario` reads back to the same run.

        `stored`: for the folder of the run, which holds copies of the files that it names.
        """
        implied = {"xi_height", "speed_max", "slope"}  # xi and gravity say the same
        implied |= {"time_history"} - self.model_fields_set  # not asked for
        table = self.model_dump(by_alias=True, exclude_none=True, exclude=implied | set(SECTIONS))
        given = self.model_dump(include=set(SECTIONS), exclude_unset=True)
        given["material"] = {name: self._material_table(name) for name in self.material_names}
        for name, file in self.body_files.items():
            given["body"][name] |= {"file": _name_of(file, stored), "digest": file.digest}
        if self.terrain_input is not None:
            file = self.terrain_input
            table["terrain"] |= {"file": _name_of(file, stored), "digest": file.digest}
        if self._earlier is not None:
            table["start"] |= {
                "from": [_name_of(file, stored) for file in self.start_files],
                "time": self.begins_at,
                "digests": [file.digest for file in self.start_files],
            }
        return to_toml(table | {name: given.get(name, {}) for name in SECTIONS})

    def values(self) -> dict[str, Any]:
        """Every key that has a value, defaults among them, and the materials in use, as tables of
        plain numbers, words and lists.
        """
        table = self.model_dump(by_alias=True, exclude_none=True)
        in_use = {name: self._material_table(name).items() for name in self.material_names}
        kept = {name: {k: v for k, v in table if v is not None} for name, table in in_use.items()}
        return table | {"material": kept}

    def _material_table(self, name: str) -> dict[str, Any]:
        """What the scheme has of a material; to_toml leaves out what is None."""
        others = {p.name for p in MATERIAL_PARAMETERS if p.scheme not in (None, self.scheme)}
        others |= fracture_keys(self.materials[name].fracture)
        if not self.materials[name].has_sound:
            others.add("speedsound")
        values = self.materials[name].table().items()
        return {key: value for key, value in values if key not in others | {"name"}}


def _name_of(file: InputFile, stored: bool) -> str:
    """As a scenario names it, or as the one in the folder of a run does."""
    return f"{INPUTS}/{file.name}" if stored else str(file.path)


def file_of(where: Where, name: str, file: str) -> Path:
    """The file of [body.NAME]; its path is relative to the scenario file that names it."""
    return where.file(("body", name, "file"), file)


def terrain_file(where: Where, terrain: Terrain) -> Path:
    """The file of [terrain]; its path is relative to the scenario file that names it."""
    return where.file(("terrain", "file"), terrain.file)


def names_in_use(tables: ScenarioTable, read: Mapping[str, ParticleTable]) -> list[str]:
    """The materials of bodies, of the particles `read` from files, and of inflows, none twice."""
    used: list[str] = []
    for name, body in tables.body.items():
        if name in read:
            used += read[name].material_names
        elif body.material is not None:
            used.append(body.material)
    used += [inflow.material for inflow in tables.inflow.values()]
    used += [] if tables.terrain is None else [tables.terrain.material]
    return list(dict.fromkeys(used))


def min_sound_speed(
    tables: ScenarioTable, materials: Mapping[str, Material], in_use: list[str]
) -> float:
    """Smallest unscaled sound speed that counts, m/s: in the resolved scheme walls have none."""
    fluids = [name for name in in_use if materials[name].law == "fluid"]
    limiting = fluids if tables.scheme == RESOLVED and fluids else in_use
    return min(materials[name].speedsound for name in limiting)
