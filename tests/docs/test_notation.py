"""docs/notation.md says what the declarations say."""

from __future__ import annotations

from pathlib import Path

import pytest

from doseki.record.fields import FIELDS
from doseki.scenario.materials import (
    BUILT_IN,
    EQUATIONS_OF_STATE,
    FRACTURES,
    HYPERELASTIC_LAWS,
    MATERIAL_PARAMETERS,
    RHEOLOGIES,
)
from doseki.scenario.schemes import RESOLVED_DEFAULTS, RESOLVED_ETA
from doseki.scenario.tables.root import ScenarioTable

NOTATION = Path(__file__).resolve().parents[2] / "docs" / "notation.md"


@pytest.fixture(scope="module")
def rows():
    """The rows of all tables, as lists of cells."""
    lines = NOTATION.read_text(encoding="utf-8").splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if "|" in line]


@pytest.mark.parametrize("field", FIELDS, ids=lambda field: field.key)
def test_every_field_has_its_row(rows, field):
    in_3d, in_2d = field.unit_in(3), field.unit_in(2)
    unit = in_3d if in_2d == in_3d else f"{in_3d}; 2-D: {in_2d}"
    assert [field.doc, unit, f"`{field.key}`", f"`{field.file_name}`"] in [row[1:] for row in rows]


@pytest.mark.parametrize("parameter", MATERIAL_PARAMETERS, ids=lambda parameter: parameter.name)
def test_every_material_parameter_has_its_row(rows, parameter):
    assert [parameter.doc, parameter.unit, f"`{parameter.name}`"] in [row[1:] for row in rows]


@pytest.mark.parametrize(
    "law",
    [
        law
        for family in (RHEOLOGIES, EQUATIONS_OF_STATE, HYPERELASTIC_LAWS, FRACTURES)
        for law in family.values()
    ],
    ids=lambda law: law.name,
)
def test_every_law_has_its_row(rows, law):
    assert [f"`{law.name}`", law.doc, ", ".join(law.schemes)] in rows


@pytest.mark.parametrize("material", BUILT_IN.values(), ids=lambda material: material.name)
def test_every_built_in_material_has_its_row(rows, material):
    numbers = (material.rho0, material.speedsound, material.shear_modulus, material.nu)
    assert [f"`{material.name}`", material.law, *(f"{value:g}" for value in numbers)] in rows


@pytest.mark.parametrize("key", ["eta", "alpha", "cflnumber", "cfl_force", "g", "skin"])
def test_defaults_of_the_scheme(rows, key):
    default = ScenarioTable.model_fields[key].default
    assert any(f"`{key}`" in row[2] and row[3] == f"{default:g}" for row in rows if len(row) == 4)


@pytest.mark.parametrize("key", ["kernel", "eos", "turbulence", "smagorinsky"])
def test_defaults_of_the_resolved_scheme(rows, key):
    default = RESOLVED_DEFAULTS.get(key, ScenarioTable.model_fields[key].default)
    assert any(row[2] == f"`{key}`" and row[3] == f"{default}" for row in rows if len(row) == 4)


def test_numbers_of_the_resolved_scheme(rows):
    limits = ", ".join(str(RESOLVED_DEFAULTS[key]) for key in ("cflnumber", "cfl_force"))
    eta = "{wendland_c2} (C6: {wendland_c6})".format(**RESOLVED_ETA)
    assert limits in [row[3] for row in rows if row[2] == "`cflnumber`, `cfl_force`"]
    assert eta in [row[3] for row in rows if row[2] == "`eta`"]
    form = "stress (mu(I), mud on Voellmy beds: morris)"
    assert form in [row[3] for row in rows if row[2] == "`viscosity`"]
