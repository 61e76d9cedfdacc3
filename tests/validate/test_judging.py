"""From runs to verdicts."""

import math

from doseki.errors import PhysicsError
from doseki.validate.case import Control, Criterion, Outcome, Value, within
from doseki.validate.judging import FAIL, PASS, REPORTED, SHORT, failed, validate_case


def judge(case, tier="full"):
    told = []
    result = validate_case(case, tier, told.append)
    return result, told


def test_a_case_passes_with_its_order(make_case):
    result, told = judge(make_case())
    assert result.verdict == PASS
    assert [row.resolution for row in result.rows] == [10, 20, 40, 10]
    assert [row.order is None for row in result.rows] == [True, True, False, True]
    assert abs(result.rows[2].order - 2) < 1e-6
    assert len(told) == 4


def test_the_coarse_tier_runs_the_coarsest_and_the_control(make_case):
    result, _ = judge(make_case(), "coarse")
    assert [row.resolution for row in result.rows] == [10, 10]
    assert result.verdict == PASS


def test_outside_the_band_fails(make_case):
    result, _ = judge(make_case(tolerance=0.001))
    assert [row.verdict for row in result.rows[:3]] == [FAIL, FAIL, PASS]
    assert failed([result])


def test_too_low_an_order_fails_on_the_finest(make_case):
    result, _ = judge(make_case(order=2.5))
    assert [row.verdict for row in result.rows] == [PASS, PASS, FAIL, PASS]


def test_a_control_that_passes_fails_the_case(make_case):
    result, _ = judge(make_case(wrong=1.0))
    assert result.rows[-1].verdict == FAIL
    assert result.rows[-1].note == "control: wrong"


def test_a_control_without_a_number_tells_nothing(make_case):
    control = Control("wrong", "value", lambda _: Outcome({"value": Value(math.nan, 2.0)}))
    result, _ = judge(make_case(controls=(control,)))
    assert result.rows[-1].verdict == FAIL


def test_without_a_band_it_is_only_reported(make_case):
    case = make_case(criteria=(Criterion("value", (None,), "no band"),), controls=())
    result, _ = judge(case)
    assert {row.verdict for row in result.rows} == {REPORTED}
    assert result.verdict == PASS


def test_a_run_that_goes_wrong_fails_with_its_message(make_case):
    def broken(_resolution):
        raise PhysicsError("the density became nan")

    result, _ = judge(make_case(run=broken))
    assert result.verdict == FAIL
    assert "nan" in result.rows[0].note
    assert not result.outcomes


def test_what_is_known_to_fall_short_is_not_a_pass(make_case):
    short = Criterion("value", (within(0.001),), "made up", short="a reason")
    result, _ = judge(make_case(criteria=(short,)))
    assert [row.verdict for row in result.rows[:3]] == [SHORT, SHORT, PASS]
    assert result.rows[0].note == "a reason"
    assert failed([result])
