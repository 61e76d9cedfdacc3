"""The picture of a grading."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.figures.census import draw_grading
from doseki.figures.nothing import NothingToDrawError
from doseki.figures.text import plain_text
from doseki.measure.grading import Grading


def grading(*sizes):
    """Bodies of these sizes, m, and of the mass of discs."""
    size = np.sort(np.array(sizes))
    mass = size**2
    return Grading(np.arange(len(size)), size, mass, np.cumsum(mass) / mass.sum())


def test_sizes_are_numbers_and_curves_those_that_differ():
    """Titles and ticks are drawn as they are written, so that a tick must not be a formula."""
    gradings = {0.0: grading(0.05), 1.0: grading(0.05), 2.0: grading(0.002, 0.03, 0.04)}
    gradings[3.0] = gradings[2.0]
    with plain_text():
        figure = draw_grading(gradings)
        figure.canvas.draw()
    axes = figure.axes[0]
    ticks = [float(label.get_text()) for label in axes.get_xticklabels() if label.get_text()]
    assert {0.002, 0.005, 0.01, 0.02, 0.05} <= set(ticks)
    assert [line.get_label() for line in axes.get_lines()] == ["0 s", "2 s"]


def test_times_when_nothing_was_loose_have_no_curve():
    axes = draw_grading({0.0: grading(), 1.0: grading(0.01, 0.02)}).axes[0]
    assert [line.get_label() for line in axes.get_lines()] == ["1 s"]
    with pytest.raises(NothingToDrawError):
        draw_grading({0.0: grading()})
