"""Every key of inflows, outflows and gauges changes the run or is refused: see walk.py."""

from __future__ import annotations

import pytest

from doseki.scenario.gauges.kinds import GAUGES
from doseki.scenario.tables.inflow import Inflow
from doseki.scenario.tables.region import Outflow

from .walk import BLOCK, NONE, REFUSED, WORDS, cases, ignored, outcome, replaced, text_of

FLOWS = {
    "array": ["{ count = {copies}, step = [-0.2, {zeros}0] }"],
    "material": ["mud"],
    "rate": ["0.09"],
    "hydrograph": ["[[0, 0.1], [1, 0]]"],
    "surge": ["[[0, 0.1, 2], [1, 0.2, 1]]"],
    "width": ["0.4"],
    "position": ["[-0.15, {zeros}0.2]"],
    "direction": ["[1, {zeros}0.1]"],
    "depth": ["0.3"],
    "ks": [],  # of the depth "normal", and of a warning about any
    "start": ["0.001"],
    "duration": ["0.001"],
    "jitter": ["0.1"],
    "min": ["[0.2, {zeros}-1]"],
    "max": ["[0.9, {ones}1]"],
}


@cases
def test_inflows_and_outflows(tmp_path, scheme, dim):
    tables = """
[material.mud]
based_on = "water"
rho0 = 1200
[inflow.subject]
material = "water"
rate = 0.08
width = 0.3
position = [-0.2, @00.1]
direction = [1, @00]
depth = 0.2
duration = 1
[outflow.subject]
min = [0.4, @--1]
max = [0.9, @11]
"""
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, tables).replace("min = [0, ", "min = [0.2, "))
    words = {"zeros": "0, " if dim == 3 else "", "ones": "0.2, " if dim == 3 else ""}
    words["copies"] = "[2, 1, 1]" if dim == 3 else "[2, 1]"
    values = {key: [replaced(v, words) for v in entries] for key, entries in FLOWS.items()}
    assert outcome(str(path), ()) != REFUSED
    for section, table in (("inflow", Inflow), ("outflow", Outflow)):
        keys = sorted(set(table.model_fields) - WORDS)
        assert ignored(str(path), f"{section}.subject.", keys, values) == NONE


GAUGE = {
    "array": ["{ count = {copies}, step = [0.1, {zeros}0] }"],
    "position": ["[0.35, {zeros}0.1]"],
    "interval": ["0.03"],
    "material": ["aluminium"],
    "direction": ["[0.2, {zeros}1]"],
    "radius": ["0.2"],
    "area": ["0.3 with gauge.g.position=[0.2, {zeros}0]"],
    "filter_hz": ["50"],
    "length": ["0.25"],
    "count": ["3"],
    "depth": ["0.15"],
    "width": ["0.1"],
    "bodies": ['["far"]'],
    "about": ["[1, {zeros}1]"],
    "left": ["[0.3, 0.55]"],
    "right": ["[0.3, 0.05]"],
    "approach": [],  # of numbers that are worked out after the run
    "origin": ["[0.1, {zeros}0]"],
    "edges": ["{shorter}"],
    "panels": ["{finer}"],
}
FACE = """\
bodies = ["floor"]
origin = [0, @00]
edges = [[0.6, @00]{second}]
panels = [2{more}]
direction = [0, @01]
"""
SECOND = {
    2: {"second": "", "more": "", "shorter": "[[0.4, 0]]", "finer": "[3]"},
    3: {
        "second": ", [0, 0.4, 0]",
        "more": ", 2",
        "shorter": "[[0.4, 0, 0], [0, 0.4, 0]]",
        "finer": "[3, 2]",
    },
}
FAR = BLOCK.replace("block", "far").replace("velocity", "# ") + "fixed = true\n"


@cases
@pytest.mark.parametrize("kind", GAUGES.tables)
def test_gauges(tmp_path, kind, scheme, dim):
    table = GAUGES.tables[kind]
    given = {
        "position": "[0.2, @00.1]",
        "direction": "[1, @00]",
        "length": "0.3",
        "bodies": '["floor"]',
    }
    needed = [
        f"{k} = {v}\n"
        for k, v in given.items()
        if k in table.model_fields and table.model_fields[k].is_required()
    ]
    if kind == "discharge":
        needed += ["length = 0.3\n"]
    if kind == "section":
        needed += ["left = [0.3, 0.5]\nright = [0.3, 0.1]\n"]
    if kind == "panels":
        needed = [replaced(FACE, SECOND[dim])]
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, f'{FAR}[gauge.g]\nkind = "{kind}"\n{"".join(needed)}'))
    if outcome(str(path), ()) == REFUSED:
        pytest.skip("no such gauge in this scheme")
    words = {"zeros": "0, " if dim == 3 else "", "copies": "[2, 1, 1]" if dim == 3 else "[2, 1]"}
    words |= SECOND[dim]
    values = {key: [replaced(v, words) for v in entries] for key, entries in GAUGE.items()}
    if kind == "panels":  # where it says only which side of the face the flow is on
        values["direction"] = [replaced("[0, {zeros}-1]", words)]
    keys = sorted(set(table.model_fields) - WORDS)
    assert ignored(str(path), "gauge.g.", keys, values) == NONE
