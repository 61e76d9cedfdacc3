"""Values, bands and what a case refuses to be."""

import math

import pytest

from doseki.validate.case import Criterion, Value, at_most, between, small, within


@pytest.mark.parametrize(
    ("value", "error"),
    [(Value(1.1, 1.0), 0.1), (Value(-1.9, -2.0), -0.05), (Value(0.3), 0.3), (Value(0.3, 0), 0.3)],
)
def test_error_is_relative_where_something_is_expected(value, error):
    assert value.error == pytest.approx(error)


@pytest.mark.parametrize(
    ("band", "good", "bad"),
    [
        (within(0.01), Value(1.0099, 1.0), Value(0.98, 1.0)),
        (between(2, 3), Value(2.0), Value(1.99)),
        (at_most(1e-5), Value(-7.0), Value(2e-5)),
        (small(0.3), Value(-0.3), Value(-0.31)),
    ],
)
def test_bands(band, good, bad):
    assert band.holds(good)
    assert not band.holds(bad)
    assert not band.holds(Value(math.nan, good.expected))


@pytest.mark.parametrize(
    ("band", "text"),
    [
        (within(0.005), "error within 0.5 %"),
        (between(0, 1), "0 to 1"),
        (at_most(1e-5), "at most 1e-05"),
        (small(0.3), "size at most 0.3"),
    ],
)
def test_bands_say_what_they_are(band, text):
    assert str(band) == text


def test_a_band_per_resolution_or_one_for_all(make_case):
    one = Criterion("value", (within(0.1),), "")
    each = Criterion("value", (within(0.1), None, within(0.3)), "")
    assert [one.band(k) for k in range(3)] == [within(0.1)] * 3
    assert [each.band(k) for k in range(3)] == [within(0.1), None, within(0.3)]
    with pytest.raises(ValueError, match="1 or 3 bands"):
        make_case(criteria=(Criterion("value", (within(0.1),) * 2, ""),))


def test_resolutions_must_rise(make_case):
    with pytest.raises(ValueError, match="rise"):
        make_case(resolutions=(20, 10, 40))


def test_a_control_needs_a_criterion(make_case):
    with pytest.raises(ValueError, match="no criterion"):
        make_case(criteria=())


def test_tiers(make_case):
    assert make_case().resolutions_of("coarse") == (10,)
    assert make_case().resolutions_of("full") == (10, 20, 40)
