"""The study file of docs/how-to/studies.md is one."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from tests.studies.small_study import STUDY, write_study

from doseki.studies.plan.file import KINDS, read_plan

from .markdown import blocks_of

PAGE = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "studies.md"


def test_the_first_study_can_be_run(tmp_path):
    blocks = blocks_of(PAGE.read_text())
    (text,) = (block.text for block in blocks if "scenario = " in block.text)
    path = tmp_path / "study.toml"
    path.write_text(text)
    plan = read_plan(path)
    assert len(plan.points()) == 24
    assert plan.units() == {"flow": "m2/s", "arrival": "s"}


@pytest.mark.parametrize("section", KINDS)
def test_every_kind_and_its_keys_are_told(section):
    text = PAGE.read_text()
    for kind, table in KINDS[section].items():
        assert f"`{kind}`" in text or f'kind = "{kind}"' in text
        for key in table.model_fields:
            assert re.search(rf"\b{key}\b", text), f"{section} {kind}: {key}"


def test_words_of_the_page_are_keys(tmp_path):
    extra = '[cluster]\nkind = "slurm"\nminutes = 120\nmemory_gb = 4\nat_once = 100\n'
    extra += 'partition = "compute"\nsetup = ["module load gcc"]\n'
    assert all(line in PAGE.read_text() for line in extra.splitlines())
    assert read_plan(write_study(tmp_path, STUDY + extra)).cluster.at_once == 100
