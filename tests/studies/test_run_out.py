"""What a study reads of how far a flow went."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from doseki.studies.reading.results import RunOut


def test_a_flow_that_stays_where_it_started_has_run_out_no_metre():
    """A calibration must see it as short, which is no run without a result."""
    no_farther = {"top": (1.0, 2.0, 3.0), "toe": None, "distance": None, "angle": None, "area": 4.0}
    distance, angle, area = (
        RunOut(kind="run_out", value=value) for value in ("distance", "angle", "area")
    )
    stays = SimpleNamespace(summary={"runout": no_farther})
    assert (distance.read(stays), area.read(stays)) == (0.0, 4.0)
    assert np.isnan(angle.read(stays))
    for runout in (None, no_farther | {"top": None}):
        assert np.isnan(distance.read(SimpleNamespace(summary={"runout": runout})))
    far = SimpleNamespace(summary={"runout": no_farther | {"distance": 7.0}})
    assert distance.read(far) == 7.0
