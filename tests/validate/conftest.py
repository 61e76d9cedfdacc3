"""A made-up case whose error falls with a given order."""

from collections.abc import Callable

import numpy as np
import pytest

from doseki.validate.case import Case, Control, Criterion, Curve, Outcome, Value, within

SIZES = (10, 20, 40)


def made_up(resolution: float, order: float = 2.0, scale: float = 1.0) -> Outcome:
    """A value of 2 with an error of scale resolution^-order."""
    value = Value(2 * (1 + scale * resolution**-order), 2.0)
    line = np.linspace(0, 1, 5)
    return Outcome({"value": value}, [Curve("", line, line)], [Curve("exact", line, line)])


@pytest.fixture
def make_case() -> Callable[..., Case]:
    """A case with a criterion and, unless told otherwise, a control that fails."""

    def make(tolerance=0.02, order=1.8, wrong=10.0, run=made_up, **changes) -> Case:
        control = Control("wrong", "value", lambda n: made_up(n, scale=wrong))
        given = {
            "name": "made-up",
            "title": "A made-up case",
            "across": "L/dp",
            "resolutions": SIZES,
            "run": run,
            "criteria": (Criterion("value", (within(tolerance),), "made up", order=order),),
            "axes": ("x", "y"),
            "controls": (control,),
        }
        return Case(**given | changes)

    return make
