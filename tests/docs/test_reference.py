"""The generated reference says what the code does."""

from __future__ import annotations

import re

import pytest
import typer
from docs.site.generated.commands import command_pages
from docs.site.generated.equations import TAG, cited_numbers, citing_files, headings_of
from docs.site.generated.fields import field_pages
from docs.site.generated.key_types import meaning_of
from docs.site.generated.keys import key_pages
from docs.site.generated.python_api import api_pages

import doseki
from doseki.cli.app import app
from doseki.errors import UserError
from doseki.record.fields import FIELDS, GRAIN_FIELDS
from doseki.scenario.load import load_scenario
from doseki.scenario.table import Kinds
from doseki.scenario.tables.root import ScenarioTable
from doseki.scenario.tables.sections import SECTIONS, SINGLE_TABLES

from ..scenario.every_key.test_top_level import ELSEWHERE, OF_RECORD
from ..scenario.every_key.test_top_level import ROOT as VALUES
from ..scenario.every_key.walk import BLOCK, WORDS, cases, text_of
from .markdown import ROOT


@pytest.fixture(scope="module")
def keys():
    """The pages of keys by the name of the table."""
    return {place.rpartition("/")[2].removesuffix(".md"): text for place, text in key_pages()}


def rows_of(text: str) -> dict[str, list[str]]:
    """The rows of tables by the key in the first cell."""
    rows = [[c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]] for line in text.splitlines()]
    return {row[0].strip("`"): row for row in rows if row and row[0].startswith("`")}


def test_every_key_has_a_row(keys):
    for name, kind in {**SECTIONS, **SINGLE_TABLES}.items():
        kinds = kind.tables.values() if isinstance(kind, Kinds) else [kind]
        for table in kinds:
            names = {info.alias or key for key, info in table.model_fields.items()}
            assert names <= set(rows_of(keys[name]))
    top = set(ScenarioTable.model_fields) - {*SECTIONS, *SINGLE_TABLES, "schema_version"}
    assert top | {"schema"} == set(rows_of(keys["top"]))


def test_a_row_says_type_unit_default_and_who_obeys(keys):
    row = rows_of(keys["top"])["dp"]
    assert row[1:5] == ["number; above 0", "m", "*required*", "all"]
    row = rows_of(keys["top"])["alpha"]
    assert row[1:5] == ["number; from 0", "", "`1.0`", "ueta2022"]
    assert rows_of(keys["body"])["clamped"][4] == "resolved, elastic bodies"
    assert rows_of(keys["material"])["yield_stress"][2] == "Pa"
    assert "Only for 3-D runs." in keys["gauge"]
    assert "Only for the resolved scheme." in keys["gauge"]


@cases
def test_who_obeys_is_who_accepts(tmp_path, keys, scheme, dim):
    """A key of the top level is refused just where its row says that it is not obeyed."""
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, BLOCK))
    rows = rows_of(keys["top"])
    skipped = WORDS | OF_RECORD | ELSEWHERE | {"dim", "scheme", "gravity", "domain_min"}
    for key in sorted(set(ScenarioTable.model_fields) - skipped - {"domain_max", "periodic", "g"}):
        values = [v.partition(" with ") for v in VALUES[key]]
        said = rows[key][4]
        declared = said == "all" or scheme in said
        default = str(ScenarioTable.model_fields[key].default)
        others = [(value, also) for value, _, also in values if value != default]
        accepted = any(accepts(path, [*also.split("; "), f"{key}={v}"]) for v, also in others)
        assert accepted == declared, f"{key}: {said}, but {scheme} accepts it: {accepted}"


def accepts(path, settings):
    """Whether a scenario may be read with these settings."""
    try:
        load_scenario(str(path), [s for s in settings if s])
    except UserError:
        return False
    return True


def test_a_type_without_words_is_noticed():
    info = ScenarioTable.model_fields["dp"]._copy()
    info.annotation = complex
    with pytest.raises(KeyError):
        meaning_of(info)


def test_every_command_and_option_is_listed():
    ((_, text),) = command_pages()
    for name, command in typer.main.get_command(app).commands.items():
        assert f"## doseki {name}\n" in text
        for parameter in command.params:
            if parameter.param_type_name == "option":
                assert all(f"`{option}`" in text for option in parameter.opts)


def test_every_field_is_listed():
    ((_, text),) = field_pages()
    for field in (*FIELDS, *GRAIN_FIELDS):
        assert f"| `{field.key}` | `{field.file_name}` |" in text


def test_all_that_doseki_exports_is_listed():
    ((_, text),) = api_pages()
    for name in doseki.__all__:
        assert name.startswith("__") or f":: doseki.{name}\n" in text
    assert "doseki.record.reader.Snapshot\n" in text


def test_every_equation_has_a_heading():
    text = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
    headings = headings_of(ROOT)
    assert set(headings) == set(TAG.findall(text))
    assert headings["30"] == "Momentum"


@pytest.mark.parametrize(
    ("text", "numbers"),
    [
        ("Eq. (30)", {"30"}),
        ("eqs. 9 and 11", {"9", "11"}),
        ("Eqs. (42) to (44), and (83a)", {"42", "43", "44", "83a"}),
        ("/// which Eqs. (65)\n/// and (91) have", {"65", "91"}),
        ("equal 30", set()),
    ],
)
def test_citations_are_read(text, numbers):
    assert cited_numbers(text) == numbers


def test_files_that_cite_are_found():
    files = citing_files(ROOT, {"13", "99999"})
    assert any(name.startswith("core/") for name in files["13"])
    assert "99999" not in files
