"""Loading: from a TOML file and --set options to a checked scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ..errors import UserError
from ..util.finding import Finding
from ..util.input_file import digest_of
from .bed import Bed, read_bed
from .checks.flaws import halves_of_flaws
from .checks.light_bodies import stable_cflnumber
from .checks.references import check_names, check_references
from .checks.tables import check_scenario
from .earlier import earlier_run
from .hydrographs import completed_inflows
from .materials import Material, MaterialError, complete_materials, equation_of_state
from .model import Found, Scenario, file_of, min_sound_speed, names_in_use, terrain_file
from .named_files import read_in_full
from .particle_files.reader import ParticleTable, read_particles
from .reading.changes import with_changes
from .reading.copies import with_copies
from .reading.files import find_scenario, merged_table, read_with_bases, scenario_folder
from .reading.messages import to_user_error
from .reading.overrides import changes_of
from .reading.resolve import resolve_table
from .reading.units import in_own_units
from .releases import completed_release
from .schemes import with_scheme_defaults
from .tables.body import BodyTable
from .tables.root import ScenarioTable
from .tables.terrain.release import Release
from .values.toml_source import Change, Source, Where, read_toml

HISTORY_ROWS = 1000  # of a run that does not give time_history


def load_scenario(name_or_path: str | Path, overrides: Sequence[str | Change] = ()) -> Scenario:
    """Read, override, evaluate and check a scenario; raises UserError with one clear sentence."""
    sources = read_with_bases(read_toml(find_scenario(str(name_or_path))))
    return checked_scenario(sources, changes_of(overrides))


def checked_scenario(sources: Sequence[Source], changes: Sequence[Change] = ()) -> Scenario:
    """The scenario of a table and of those that it extends, changed; raises UserError.

    All scenarios are read here, whether they come from files or from Python.
    """
    where = Where(sources)
    table = with_changes(merged_table(sources, where), changes, where)
    table = with_scheme_defaults(in_own_units(table, where))
    table, constants = resolve_table(table, where)
    table = with_copies(table, where)
    try:
        tables = ScenarioTable.model_validate(table, context={"dim": table["dim"]})
    except ValidationError as error:
        raise to_user_error(error, table, where) from None
    return _completed(tables, where, constants)


def list_scenarios() -> list[tuple[str, str, Path]]:
    """(name, title, path) of the scenarios that come with doseki."""
    return [
        (path.stem, str(read_toml(path).table.get("title", "")), path)
        for path in sorted(scenario_folder().glob("*.toml"))
    ]


def _completed(tables: ScenarioTable, where: Where, constants: dict[str, Any]) -> Scenario:
    """Fill in what follows from the tables together; raises UserError where they disagree."""
    materials = _materials(tables, where)
    _check_digests(tables, where)
    read = {
        name: read_particles(file_of(where, name, body.given("file")), tables.dim, body.material)
        for name, body in tables.body.items()
        if body.is_read
    }
    check_names(tables, where)
    check_references(tables, where, materials, read)
    bed = _bed(tables, where)
    gravity = tables.gravity
    if gravity is None:
        gravity = _gravity_on_slope(tables.slope, tables.g, tables.dim)
    completed = {
        "gravity": gravity,
        "time_history": tables.time_history or tables.time_max / HISTORY_ROWS,
        "inflow": completed_inflows(tables.inflow, gravity, where),
        "xi": tables.xi or _reduction_factor(tables, gravity, materials, read),
    }
    completed["cflnumber"], doubts = stable_cflnumber(tables, materials)
    doubts += halves_of_flaws(tables, materials)
    if any(isinstance(body, Release) for body in tables.body.values()):
        completed["body"], own = _with_releases(tables, bed, where)
        doubts += own
    earlier = None if tables.start is None else earlier_run(tables.start, where)
    taken_in = read_in_full(where.named)
    found = Found(constants, read, earlier, bed, doubts, taken_in)
    scenario = Scenario.made_of(tables, completed, where, materials, found)
    check_scenario(scenario)
    return scenario


def _bed(tables: ScenarioTable, where: Where) -> Bed | None:
    """The bed of [terrain], where there is one."""
    terrain = tables.terrain
    if terrain is None:
        return None
    return read_bed(terrain_file(where, terrain), terrain, tables.dim, tables.dp, where)


def _with_releases(
    tables: ScenarioTable, bed: Bed | None, where: Where
) -> tuple[dict[str, BodyTable], list[Finding]]:
    """The bodies, releases with what their files say, and what is doubtful about these."""
    if bed is None:
        name = next(name for name, body in tables.body.items() if isinstance(body, Release))
        raise where.error(
            ("body", name), f'body.{name}: shape = "release" needs a [terrain] to lie on'
        )
    bodies, doubts = dict(tables.body), list[Finding]()
    for name, body in tables.body.items():
        if isinstance(body, Release):
            path = None if body.file is None else file_of(where, name, body.file)
            crs = None if bed.raster is None else bed.raster.crs
            bodies[name], own = completed_release(name, body, path, crs, where)
            doubts += own
    return bodies, doubts


def _check_digests(tables: ScenarioTable, where: Where) -> None:
    """Files whose content is known must still have it."""
    for name, body in tables.body.items():
        if body.given("digest") is not None and body.given("file") is not None:
            path = file_of(where, name, body.given("file"))
            _check_digest(("body", name, "digest"), path, body.given("digest"), where)
    terrain = tables.terrain
    if terrain is not None and terrain.digest is not None:
        path = terrain_file(where, terrain)
        _check_digest(("terrain", "digest"), path, terrain.digest, where)


def _check_digest(keys: tuple[str, ...], path: Path, expected: str, where: Where) -> None:
    try:
        found = digest_of(path)
    except UserError as error:
        raise where.error(keys, f"{'.'.join(keys)}: {error}") from None
    if found != expected:
        raise where.error(
            keys,
            f"{'.'.join(keys)}: {path} is not the file that was meant: its digest is {found},"
            f" expected {expected}; bring back the file, or remove the key",
        )


def _gravity_on_slope(slope: float | None, g: float, dim: int) -> np.ndarray:
    """Gravity along axes aligned with a slope, x pointing up it; zero without a slope."""
    gravity = np.zeros(dim)
    if slope is not None:
        angle = math.radians(slope)
        gravity[0], gravity[-1] = -g * math.sin(angle), -g * math.cos(angle)
    return gravity


def _materials(tables: ScenarioTable, where: Where) -> dict[str, Material]:
    given = {name: table.model_dump(exclude_none=True) for name, table in tables.material.items()}
    try:
        return complete_materials(given, equation_of_state(tables.scheme, tables.eos))
    except MaterialError as error:
        keys = ("material", error.material)
        raise where.error(keys, f"material.{error.material}: {error}") from None


def _reduction_factor(
    tables: ScenarioTable,
    gravity: np.ndarray,
    materials: Mapping[str, Material],
    read: Mapping[str, ParticleTable],
) -> float:
    """xi = 10 sqrt(2 g H)/min c0 over the materials in use (eq. 19); 1 without a height.

    With `speed_max` in place of a height it is 10 speed_max/min c0.
    """
    g = float(np.linalg.norm(gravity)) or tables.g
    speed = tables.speed_max
    if tables.xi_height is not None:
        speed = math.sqrt(2 * g * tables.xi_height)
    if speed is None:
        return 1.0
    return 10 * speed / min_sound_speed(tables, materials, names_in_use(tables, read))
