"""Checks of the names of tables, and of what tables refer to by name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ...util.spelling import suggestion
from ..materials import Material
from ..particle_files.reader import ParticleTable
from ..table import Table
from ..tables.mesh import Mesh
from ..tables.root import ScenarioTable
from ..tables.sections import SECTIONS, SINGLE_TABLES
from ..values.toml_source import Where
from ..values.types import RefersTo


def check_names(tables: ScenarioTable, where: Where) -> None:
    """Names of tables become names of files and columns, so they must be fit for that.

    Raises UserError.
    """
    for section in SECTIONS:
        for name in getattr(tables, section):
            check_name(section, name, where)


def check_name(section: str, name: str, where: Where) -> None:
    """Raise UserError for a name of a table [SECTION.NAME] that no file or column could have."""
    if not re.fullmatch(r"\w[\w .+-]{0,59}", name):
        raise where.error(
            (section, name),
            f'"{name}" cannot be a name in [{section}]; names begin with a letter or digit and have'
            " at most 60 letters, digits, spaces, _, -, + or dots",
        )


def check_references(
    tables: ScenarioTable,
    where: Where,
    materials: Mapping[str, Material],
    read: Mapping[str, ParticleTable],
) -> None:
    """Every table that is named must exist, and there must be something to run.

    Raises UserError.
    """
    if not tables.body and not tables.inflow:
        raise where.error((), "a scenario needs at least one [body.NAME] or [inflow.NAME]")
    known = {name: getattr(tables, name) for name in SECTIONS} | {"material": materials}
    for place, part in _parts(tables):
        for key, field in type(part).model_fields.items():
            for about in field.metadata:
                if isinstance(about, RefersTo):
                    keys, value = (*place, key), getattr(part, key)
                    _check_known(where, keys, value, about.section, known[about.section])
    for name, particles in read.items():
        for material in particles.material_names:
            if material not in materials:
                path = f"body.{name}.file"
                message = f'{path}: the file names the unknown material "{material}"'
                raise where.error(("body", name, "file"), message + suggestion(material, materials))


def _parts(tables: ScenarioTable) -> Iterator[tuple[tuple[str, ...], Table]]:
    """Every table of the scenario, with where it stands."""
    for name in SINGLE_TABLES:
        if (part := getattr(tables, name)) is not None:
            yield (name,), part
    for section in SECTIONS:
        for name, part in getattr(tables, section).items():
            yield (section, name), part


def _check_known(
    where: Where,
    keys: tuple[str, ...],
    value: str | list[str] | None,
    section: str,
    known: Mapping[str, object],
) -> None:
    """Raise UserError where the value at `keys`, a name or several, is not in a section."""
    path = ".".join(keys)
    if isinstance(value, str) and value not in known:
        message = f'{path} = "{value}" is not a known {section}{suggestion(value, known)}'
        raise where.error(keys, message)
    for name in value if isinstance(value, list) else ():
        if name not in known:
            message = f'{path}: "{name}" is not a known {section}{_remedy(name, known)}'
            raise where.error(keys, message)


def _remedy(name: str, known: Mapping[str, object]) -> str:
    """What may have been meant by a name; a mesh of several parts is one body."""
    whole, _, part = name.rpartition(".")
    if part.isdigit() and isinstance(known.get(whole), Mesh):
        return (
            f"; [body.{whole}] is one body with all parts of its file: give each part a file and a "
            "[body.NAME] of its own"
        )
    return suggestion(name, known)
