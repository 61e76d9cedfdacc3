"""Every key of the schema, in each scheme and kind of table: it changes the run, or is refused.

A small scene is stepped with and without each value.  A key that changes neither the particles, nor
what gauges read, nor when is ignored, and no key may be.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from doseki.compiled import load_core
from doseki.driver.gauges import build_gauges
from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

STEPS = 15
SCHEMES = {
    "ueta2022": 'scheme = "ueta2022"\nxi = 0.05\n',
    "resolved": 'scheme = "resolved"\nspeed_max = 5\n',
}
WORDS = {"title", "description", "schema_version", "enabled", "kind", "shape"}  # that name things
REFUSED, NONE = "refused", ""
Settings = Sequence[str]


def text_of(scheme: str, dim: int, tables: str = "") -> str:
    """A scene of water over a floor, and further tables; @ stands for the middle axis."""
    middle = {
        "@0": "0, " if dim == 3 else "", "@1": "0.3, " if dim == 3 else "",
        "@-": "-0.3, " if dim == 3 else "", "@+": "0.6, " if dim == 3 else "",
    }  # fmt: skip
    text = f"""\
dim = {dim}
dp = 0.1
time_max = 1
time_out = 0.1
gravity = [0, @0-9.8]
{SCHEMES[scheme]}
[material.water]
nu = 1e-3
[material.rock]
based_on = "basalt"
[body.water]
shape = "box"
material = "water"
min = [0, @00]
max = [0.6, @10.4]
jitter = 0.2
velocity = ["= 1 + y", @00.5]
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.3, @--0.3]
max = [1.6, @+0]
{tables}"""
    for word, entry in middle.items():
        text = text.replace(word, entry)
    return text


def outcome(path: str, settings: Settings) -> str:
    """What a run computes in some steps, as a digest; REFUSED where it may not start."""
    digest = hashlib.sha256()
    try:
        scenario = load_scenario(path, settings)
        simulation, names, _ = filled_simulation(scenario)
        simulation.start()
        for _ in range(STEPS):
            simulation.advance(limit=1.0, pause=1.0, max_steps=1)
        arrays = [*simulation.state().values(), *simulation.grains().values()]
        for gauge in build_gauges(scenario, names):
            arrays += [np.array(gauge.read(simulation)), np.array(gauge.interval)]
            arrays += [np.array(list(gauge.columns))]
    except UserError:
        return REFUSED
    except load_core().PhysicsFailure as failure:
        return str(failure)
    for array in [*arrays, np.array([simulation.time, simulation.skin])]:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def ignored(
    path: str,
    prefix: str,
    keys: Iterable[str],
    values: Mapping[str, Sequence[str]],
    outcome: Callable[[str, Settings], str] = outcome,
) -> str:
    """The keys under `prefix` that change nothing, as `outcome` tells, and are not refused.

    `values` has for each key what it is set to, or that and, after " with ", other settings that it
    needs.  A key without a value fails: whoever adds one says here how it shows.  A value that the
    key has anyway shows nothing.
    """
    base: dict[tuple[str, ...], str] = {}
    found = []
    for key in keys:
        assert key in values, f"{prefix}{key}: no value to try"
        for entry in values[key]:
            value, _, others = entry.partition(" with ")
            also = tuple(others.split("; ")) if others else ()
            if also not in base:
                base[also] = outcome(path, also)
            settings = (*also, f"{prefix}{key}={value}")
            changed = outcome(path, settings)
            if changed == base[also] != REFUSED and not same(path, also, settings, prefix + key):
                found.append(f"{prefix}{key} = {entry}")
    return "\n".join(found)


def same(path: str, settings: Settings, others: Settings, key: str) -> bool:
    """Whether a key has the same value with these settings and with those."""
    values: list[Any] = [load_scenario(path, settings), load_scenario(path, others)]
    for name in key.split("."):
        values = [v[name] if isinstance(v, dict) else getattr(v, name) for v in values]
    return bool(np.array_equal(values[0], values[1]))


def replaced(text: str, words: Mapping[str, str]) -> str:
    """The text with {word} replaced; other braces are those of TOML."""
    for word, entry in words.items():
        text = text.replace("{" + word + "}", entry)
    return text


CASES = [(scheme, dim) for scheme in SCHEMES for dim in (2, 3)]
cases = pytest.mark.parametrize(("scheme", "dim"), CASES, ids=lambda value: str(value))

BLOCK = """
[body.block]
shape = "box"
material = "rock"
min = [0.6, @00]
max = [1.0, @10.4]
velocity = [-1, @00]
"""
