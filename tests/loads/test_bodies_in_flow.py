"""Bodies in the flow that a section sees: design formulas say that they count."""

from __future__ import annotations

import pytest

from doseki.assess.loads import as_csv, as_json, load_lines, loads_of
from doseki.scene.checks.structures import BodiesInFlow
from doseki.solver.build import filled_simulation

from .scenes import RUSH, run_of, scenario_of

# Before the wall.
BOULDER = """
[body.boulder]
shape = "disc"
material = "basalt"
centre = [0.7, 0.2]
radius = 0.1
"""
FLOW = "gauge.before.material='water'"
DRY = "body.water.material='basalt'"


@pytest.mark.parametrize(
    ("text", "keys", "told"),
    [
        (RUSH + BOULDER, [], True),
        (RUSH + BOULDER, [FLOW], False),
        (RUSH, [], False),
        (RUSH + BOULDER, [DRY], False),  # bodies are the flow
    ],
)
def test_a_section_that_takes_bodies_for_flow_is_warned_of(tmp_path, text, keys, told):
    warnings = filled_simulation(scenario_of(tmp_path, text, *keys)).warnings
    found = [str(each) for each in warnings if isinstance(each, BodiesInFlow)]
    assert bool(found) == told
    if told:
        (said,) = found
        assert said.startswith("gauge.before: has no `material`")
        assert "body.boulder as flow" in said
        assert 'set its `material` to "water"' in said
        assert "gauge.dam" in said


def test_of_many_bodies_two_are_named():
    said = str(BodiesInFlow("gauge.before", ("a", "b"), ("x", "y", "z"), ("mud", "water")))
    assert "body.x, body.y and 1 more as flow" in said
    assert "gauge.a and gauge.b" in said
    assert "that of the flow" in said


@pytest.mark.parametrize(("keys", "told"), [([], True), ([FLOW], False)])
def test_loads_say_that_bodies_are_in_the_flow(tmp_path, keys, told):
    loads = loads_of(run_of(tmp_path, RUSH + BOULDER, *keys))
    lines = [text for _, text in load_lines(loads)]
    assert any(line.startswith("rho v2 h b, with bodies: ") for line in lines) == told
    assert any("gauge.before has no `material`" in line for line in lines) == told
    assert ("Huebl & Holzinger (2003), with bodies" in as_csv(loads)) == told
    of_dam = as_json(loads)["bodies"]["dam"]
    assert of_dam["design_with_bodies"] == told
    assert of_dam["design"][0]["formula"] == "rho v2 h b"
