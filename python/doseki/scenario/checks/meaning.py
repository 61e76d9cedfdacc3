"""Checks that every key that is given means something in its run: none is ignored."""

from __future__ import annotations

from collections.abc import Iterator

from ..model import Scenario
from ..table import Only, Table, limited_keys
from ..tables.sections import SECTIONS, SINGLE_TABLES
from ..values.toml_source import KeyPath, dotted


def check_meaning(scenario: Scenario) -> None:
    """Raise UserError for a key that the scheme, the dimension or the body does not have."""
    for keys, table in _tables(scenario):
        for key, only in limited_keys(type(table)):
            objection = _objection(scenario, table, only)
            if objection is not None and not table.has_default(key):
                path = (*keys, key)
                raise scenario.where.error(path, f"{dotted(path)}: {objection}; remove it")


def _tables(scenario: Scenario) -> Iterator[tuple[KeyPath, Table]]:
    yield (), scenario
    for section in SINGLE_TABLES:
        if (table := getattr(scenario, section)) is not None:
            yield (section,), table
    for section in SECTIONS:
        for name, table in getattr(scenario, section).items():
            yield (section, name), table


def _objection(scenario: Scenario, table: Table, only: Only) -> str | None:
    """Why a key means nothing; None where it does."""
    if only.scheme not in (None, scenario.scheme):
        return f"only the scheme {only.scheme} has it, and this run is {scenario.scheme}"
    if only.dim not in (None, scenario.dim):
        return f"only a {only.dim}-D run has it"
    fixed = table.given("fixed")  # None of what is fixed by its nature
    if only.fixed is not None and fixed is not None and fixed is not only.fixed:
        return "only a body with fixed = true has it" if only.fixed else "a fixed body has none"
    return None
