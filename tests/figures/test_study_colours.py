"""The colours of what a study came to."""

import numpy as np
import pytest

from doseki.figures.studies.responses import Column, parallel_coordinates


def test_the_colours_of_a_result_that_all_runs_have_end_a_tenth_beyond_it():
    columns = [Column("a", np.arange(3.0)), Column("b", np.arange(3.0))]
    figure = parallel_coordinates(columns, Column("front [m]", np.full(3, 0.1)), "")
    low, high = figure.axes[-1].get_ylim()
    assert (low, high) == pytest.approx((0.09, 0.11))
