"""Study files with hostile values are read, or refused with one sentence."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from doseki.errors import UserError
from doseki.studies.plan.file import read_plan

from ..studies.small_study import STUDY, write_study
from .examples import examples

STUDY_OF_ALL = (
    STUDY.replace("values = [5, 10, 20]", 'min = 5\nmax = 20\nscale = "log"').replace(
        '"grid"', '"sobol"\ncount = 4\nseed = 1'
    )
    + """take = "at"
at = 0.01

[result.arrival]
kind = "front_time"
x = 1

[observation.speed]
kind = "value"
result = "speed"
value = 1
error = 0.1
weight = 2

[observation.centre]
kind = "series"
file = "o.csv"
gauge = "centre"
column = "y"

[bands.block]
kind = "profile"
time = 0.01
min = 0
max = 1
percent = [5, 50, 95]

[calibrate]
method = "differential_evolution"
population = 6

[cluster]
kind = "local"
setup = ["true"]

[set]
time_max = 0.02
"""
)
WORDS = [
    "nan", "inf", "-1", "0", "1e308", "1e999", '""', '"x"', "[]", "[1]", "[[1]]", "{}", "{a = 1}",
    "true", '"1 kg"', '"= 1/0"', '"../../etc/passwd"', "99999999999999999999", r'"\u0000"',
    "[1, 'a']", "1979-05-27",
]  # fmt: skip
LINES = STUDY_OF_ALL.splitlines()
KEYS = [number for number, line in enumerate(LINES) if "=" in line]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With an observation that can be used."""
    found = tmp_path_factory.mktemp("study")
    (found / "o.csv").write_text("time,y,error\n0,1,1\n0.01,1,1\n")
    return found


def test_the_study_itself_is_good(folder):
    assert len(read_plan(write_study(folder, STUDY_OF_ALL)).points()) == 4


@examples(60, 1500)
@given(number=st.sampled_from(KEYS), word=st.sampled_from([*WORDS, None]))
def test_a_hostile_value_is_read_or_refused(folder, number, word):
    lines = list(LINES)
    key = lines[number].partition("=")[0]
    lines[number] = "" if word is None else f"{key}= {word}"
    with suppress(UserError):
        read_plan(write_study(folder, "\n".join(lines))).points()
