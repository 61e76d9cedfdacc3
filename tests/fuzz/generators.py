"""Scenario texts and particle files, right ones and wrong ones."""

from __future__ import annotations

import copy
import io
from typing import Any

import h5py
import numpy as np
from hypothesis import strategies as st

from doseki.util.toml_writer import to_toml

BASE: dict[str, Any] = {
    "schema": 1,
    "title": "fuzz",
    "dim": 2,
    "dp": 0.01,
    "time_max": 0.1,
    "time_out": 0.01,
    "xi": 0.05,
    "slope": 20,
    "alpha": 1.0,
    "cflnumber": 0.1,
    "periodic": ["x"],
    "domain_min": [0.0, -1.0],
    "domain_max": [0.2, 1.0],
    "parameters": {"depth": {"value": 0.02, "min": 0.001, "unit": "m"}},
    "material": {"mud": {"based_on": "water", "rho0": 1500.0}},
    "body": {
        "bed": {
            "shape": "box",
            "material": "aluminium",
            "fixed": True,
            "min": [0, -0.03],
            "max": [0.2, 0],
        },
        "gate": {
            "shape": "box",
            "material": "aluminium",
            "fixed": True,
            "min": [0, 0.2],
            "max": [0.03, 0.3],
            "motion": {"velocity": [0, 1], "start": 0.01, "stop": 0.02, "removed_at": 0.05},
        },
        "film": {"shape": "box", "material": "mud", "min": [0, 0], "max": [0.2, "= depth"]},
        "grain": {"shape": "disc", "material": "basalt", "centre": [0.1, 0.1], "radius": 0.02},
        "dots": {"shape": "points", "material": "basalt", "position": [[0.1, 0.2]], "mass": 0.2},
    },
    "inflow": {
        "water": {
            "material": "water",
            "rate": "3 L/s",
            "width": 0.1,
            "position": [0.15, 0.3],
            "direction": [-1, 0],
            "depth": 0.02,
            "duration": 0.05,
        },
        "river": {
            "material": "water",
            "hydrograph": [[0, "0 L/s"], [0.01, "3 L/s"], [0.02, 0.001]],
            "width": 0.1,
            "position": [0.15, 0.6],
            "direction": [-1, 0],
            "depth": 0.02,
            "start": 0.01,
        },
        "stream": {
            "material": "water",
            "rate": 0.1,
            "width": 1,
            "position": [0.15, 0.8],
            "direction": [-1, 0],
            "depth": "normal",
            "ks": 0.001,
            "duration": 0.01,
        },
    },
    "gauge": {
        "depth": {"kind": "surface_height", "position": [0.1, 0], "interval": 0.01},
        "speeds": {"kind": "velocity_profile", "position": [0.1, 0], "length": 0.1, "count": 5},
        "flux": {"kind": "discharge", "position": [0.1, 0], "direction": [-1, 0], "depth": 0.1},
        "toe": {"kind": "pressure", "position": [0.1, 0], "radius": 0.02, "material": "water"},
    },
    "outflow": {"end": {"min": ["-inf", "-inf"], "max": ["inf", -0.5]}},
    "window": {"all": {"min": [0, -1], "max": [1, 1]}},
    "figure": {
        "end": {"kind": "snapshot", "window": "all", "colour": ["velocity_x"]},
        "depth": {"kind": "gauge", "gauge": "depth", "columns": ["height"]},
    },
}

# The resolved scheme with walls of each kind, grains, an elastic plate, an inflow and an outflow.
EVERYTHING = """\
schema = 1
dim = 2
dp = 0.01
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 2.0
gravity = [0.0,-9.8]
attraction = 0.0
eta = 1.2
smagorinsky = 0.12
turbulence = "smagorinsky"
cflnumber = 0.1
cfl_force = 0.1
skin = 0.05
periodic = []
domain_min = [0.0,-1.0]
domain_max = [0.3,1.0]

[contact]
overlap = 0.01
speed = 2.0
steps = 20

[material.mud]
based_on = "water"
rho0 = 1500.0

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.005
min = [0.0,-0.03]
max = [0.3,0.0]

[body.water]
shape = "box"
material = "mud"
min = [0.0,0.0]
max = [0.3,0.04]

[body.gate]
shape = "box"
material = "aluminium"
fixed = true
min = [0.0,0.3]
max = [0.03,0.4]
motion = {velocity=[0.0,1.0],start=0.0005,stop=0.001,removed_at=0.0015}

[body.grains]
shape = "disc"
material = "basalt"
min = [0.05,0.1]
max = [0.15,0.2]
d = 0.02
count = 8

[body.plate]
shape = "box"
material = "basalt"
kinematics = "elastic"
min = [0.2,0.1]
max = [0.25,0.15]

[inflow.source]
material = "water"
rate = 0.01
width = 1.0
position = [0.02,0.06]
direction = [1.0,0.0]
depth = 0.03
duration = 0.001
start = 0.0005
jitter = 0.1

[gauge.depth]
kind = "surface_height"
position = [0.1,0.0]
interval = 0.001

[outflow.end]
min = [0.28,-1.0]
max = [0.3,1.0]
"""

# What people, and those who mean harm, write in place of a value.
JUNK = st.one_of(
    st.sampled_from(
        [
            0,
            -1,
            1e300,
            -1e300,
            1e-300,
            2**63,
            10**40,
            float("nan"),
            float("inf"),
            True,
            "",
            " ",
            "= 1/0",
            "= 10**10**10",
            "= 'a'*10**9",
            "= __import__('os')",
            "= depth.__class__",
            "= [x for x in range(9)]",
            "= 9**9**9**9",
            "= dp if",
            "../../../etc/passwd",
            "/dev/zero",
            "\u202egnp.exe",
            "a\nb",
            "nan",
            "1e400 L/s",
            "-3 L/s",
            "土石流",
            "\x00",
            "x" * 5000,
            [],
            {},
            [[[]]],
            [1],
            [1, 2, 3],
            ["inf", "-inf"],
            {"value": 1},
            {"d2": 1, "d3": 2},
            [float("nan")] * 2,
        ]
    ),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
    st.booleans(),
    st.text("=+-*/()0123456789.,e dpxiabs", min_size=2, max_size=20).map(lambda text: "=" + text),
    st.lists(st.one_of(st.integers(), st.floats(), st.text(max_size=3)), max_size=4),
)
NAMES = st.one_of(
    st.sampled_from(
        [
            "../../evil",
            "/tmp/evil",
            "..",
            ".",
            "",
            "a/b",
            "a\\b",
            "con",
            "\u202e",
            "x" * 300,
            "\x00",
            "dp",
        ]
    ),
    st.text(max_size=10),
)


def places(table: Any, path: tuple = ()) -> list[tuple]:
    """Every place in nested tables and lists."""
    items = (
        table.items()
        if isinstance(table, dict)
        else enumerate(table)
        if isinstance(table, list)
        else ()
    )
    found = []
    for key, value in items:
        found += [(*path, key), *places(value, (*path, key))]
    return found


PLACES = places(BASE)


def _container(table: Any, path: tuple) -> Any:
    for key in path[:-1]:
        table = table[key]
    return table


def changed(table: dict[str, Any], path: tuple, kind: str, junk: Any, name: str) -> dict[str, Any]:
    """The table with one place replaced, dropped, renamed or doubled under another name."""
    table = copy.deepcopy(table)
    try:
        container = _container(table, path)
        if kind == "replace":
            container[path[-1]] = copy.deepcopy(junk)
        elif kind == "drop":
            del container[path[-1]]
        elif isinstance(container, dict):
            value = container.pop(path[-1]) if kind == "rename" else container[path[-1]]
            container[name] = value
    except (KeyError, IndexError, TypeError):
        pass  # an earlier change took the place away
    return table


@st.composite
def tables(draw: st.DrawFn) -> dict[str, Any]:
    """BASE with one to three things wrong, or right after all."""
    table = BASE
    for _ in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(["replace", "replace", "drop", "rename", "double"]))
        table = changed(table, draw(st.sampled_from(PLACES)), kind, draw(JUNK), draw(NAMES))
    return table


@st.composite
def scenario_texts(draw: st.DrawFn) -> bytes:
    """A scenario file: from a table, with bytes cut out or put in, or any bytes at all."""
    try:
        data = to_toml(draw(tables())).encode("utf-8", "surrogatepass")
    except (TypeError, ValueError):
        data = b"schema = 1\n" + draw(st.binary(max_size=50))
    return draw(damaged(data))


@st.composite
def damaged(draw: st.DrawFn, data: bytes) -> bytes:
    """The same bytes, cut, overwritten or added to; often left alone."""
    kind = draw(st.sampled_from(["whole", "whole", "cut", "overwrite", "insert", "noise"]))
    place = draw(st.integers(0, max(0, len(data) - 1)))
    if kind == "cut":
        return data[:place]
    if kind == "overwrite":
        junk = draw(st.binary(min_size=1, max_size=8))
        return data[:place] + junk + data[place + len(junk) :]
    if kind == "insert":
        return data[:place] + draw(st.sampled_from(SNIPPETS)) + data[place:]
    return draw(st.binary(max_size=200)) if kind == "noise" else data


SNIPPETS = [
    b"[" * 3000,
    b"a." * 3000,
    b'"""',
    b"\xff\xfe",
    b"\x00",
    b"extends = 'flume'\n",
    b"[body.x]\n",
    b"dp = 1e-9\n",
    b"'",
    b"\r",
    b"\n\n= ",
    b"#" * 500,
    b"inf",
    b",nan,",
    b"\xef\xbb\xbf",
]
CELLS = st.one_of(
    st.sampled_from(
        [
            "0",
            "1",
            "nan",
            "inf",
            "-inf",
            "1e999",
            "-1",
            "",
            " ",
            '"',
            "0x10",
            "1_000",
            "=1+1",
            "water",
            "土",
            "9" * 400,
            "1e-320",
            "--1",
            "true",
            "../x",
        ]
    ),
    st.floats().map(repr),
)
HEADER = ["x", "y", "vx", "vy", "mass", "density", "material", "fixed", "body"]


@st.composite
def csv_files(draw: st.DrawFn) -> bytes:
    """A particle file in CSV, most of its cells right."""
    header = list(HEADER)
    if draw(st.booleans()):
        header[draw(st.integers(0, len(header) - 1))] = draw(
            st.sampled_from(["x", "z", "", "Mass", "x" * 300, "土"])
        )
    rows = [
        ["0.1", "0.2", "0", "0", "0.3", "2750", "basalt", "0", "a"]
        for _ in range(draw(st.integers(0, 4)))
    ]
    for _ in range(draw(st.integers(0, 2))):
        if rows:
            row = rows[draw(st.integers(0, len(rows) - 1))]
            row[draw(st.integers(0, len(row) - 1))] = draw(CELLS)
    text = "\n".join(",".join(row) for row in [header, *rows])
    return draw(damaged(text.encode("utf-8", "surrogatepass")))


def hdf5_file(compressed: bool) -> bytes:
    """A whole particle file in HDF5."""
    image = io.BytesIO()
    options = {"compression": "gzip"} if compressed else {}
    with h5py.File(image, "w") as file:
        for name in ("x", "y", "vx", "vy"):
            file.create_dataset(name, data=np.linspace(0, 1, 50), **options)
        file.create_dataset("mass", data=np.full(50, 0.2), **options)
        file.create_dataset("density", data=np.full(50, 2750.0), **options)
        file.create_dataset("material", data=np.array([b"basalt"] * 50), **options)
    return image.getvalue()
