"""The shipped cases: whole, findable, and at their coarsest resolution as good as they say."""

import pytest

from doseki.validate.case import Case
from doseki.validate.catalogue import all_cases
from doseki.validate.judging import FAIL, validate_case
from doseki.validate.report import remarks
from doseki.validate.running import CASES


def test_names_and_words():
    for name, case in all_cases().items():
        assert isinstance(case, Case)
        assert name == case.name == name.lower()
        assert case.title
        assert all(criterion.reason for criterion in case.criteria)
        assert len(case.resolutions) == 3


def test_scenarios_are_part_of_the_package():
    assert (CASES / "tank.toml").is_file()


@pytest.mark.minutes
@pytest.mark.parametrize("name", all_cases())
def test_coarse(name):
    result = validate_case(all_cases()[name], "coarse", lambda _: None)
    assert not [row for row in result.rows if row.verdict == FAIL], remarks([result])
