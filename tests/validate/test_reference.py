"""The tables that cases compare with: whole, small, with their source, and part of the package."""

import re

import numpy as np
import pytest

from doseki.validate.reference import DATA, read_columns
from doseki.validate.running import CASES

TABLES = sorted(path.name for path in DATA.glob("*.csv"))
MOST = 200  # numbers of a table


def test_tables_lie_beside_the_cases():
    assert CASES.parent == DATA.parent
    assert TABLES


@pytest.mark.parametrize("name", TABLES)
def test_a_table_says_where_it_is_from(name):
    lines = (DATA / name).read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    assert lines[: len(head)] == head
    assert re.search(r"(19|20)\d\d", " ".join(head))
    assert len(head[-1].split(",")) == len(read_columns(name))


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_small_and_rises(name):
    columns = read_columns(name)
    assert columns.size <= MOST
    assert np.isfinite(columns).all()
    assert (np.diff(columns[0]) > 0).all()


@pytest.mark.parametrize("name", TABLES)
def test_every_table_is_used(name):
    modules = [path.read_text(encoding="utf-8") for path in CASES.glob("*/*.py")]
    assert sum(f'"{name}"' in text for text in modules) == 1
