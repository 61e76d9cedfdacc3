"""The fitted order of convergence."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from doseki.validate.convergence import fitted_order

SIZES = [10, 20, 40]


@given(st.floats(-3, 6), st.floats(1e-8, 1e3), st.sampled_from([-1, 1]))
def test_power_laws_are_found(order, scale, sign):
    errors = sign * scale * np.array(SIZES, float) ** -order
    assert fitted_order(SIZES, errors) == pytest.approx(order, abs=1e-6)


def test_sign_of_an_error_does_not_matter():
    assert fitted_order(SIZES, [0.04, -0.01, 0.0025]) == pytest.approx(2)


def test_noise_averages_out():
    assert fitted_order(SIZES, [1.1e-2, 0.5e-2, 0.25e-2 * 1.1]) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("errors", [[0.1], [], [0.1, 0.0, 0.1], [0.1, np.nan, 0.1], [np.inf, 1, 1]])
def test_there_may_be_none(errors):
    assert fitted_order(SIZES[: len(errors)], errors) is None
