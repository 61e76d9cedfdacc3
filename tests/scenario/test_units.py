"""Strings that name a unit stand for numbers in the unit of their key, wherever a key has one."""

import math
import re

import pytest

from doseki.scenario.load import load_scenario
from doseki.scenario.reading.units import OF_SECTIONS, OF_TOP_LEVEL, in_own_units
from doseki.scenario.table import Kinds
from doseki.scenario.tables.contact import Contact
from doseki.scenario.tables.motion import Motion
from doseki.scenario.tables.root import ScenarioTable
from doseki.scenario.tables.sections import SECTIONS
from doseki.scenario.values.toml_source import Where
from doseki.scenario.values.units import UNITS, Measured, MeasuredColumns

from ..small_scenarios import BLOCK

# Numbers of no unit, numbers whose unit depends on another number, and what is no number.
PLAIN = {
    "acoustic_damping", "alpha", "cfl_force", "cflnumber", "consistency", "count", "damping",
    "cv", "dim", "direction", "eta", "flaw_seed", "flow_index", "friction",
    "gamma", "grains", "hourglass",
    "inertial_number", "panels",
    "jitter", "mu", "mu_2", "mu_s", "normal", "overlap", "packing", "poisson_ratio",
    "pore_pressure_ratio", "random_seed",
    "restitution", "rolling_friction", "rotate_axis", "sample", "scale", "schema_version",
    "skin", "smagorinsky", "steps", "weibull_m", "wetted", "where", "clamped", "xi",
}  # fmt: skip


def tables():
    """Every kind of table with what its keys measure."""
    yield ScenarioTable, OF_TOP_LEVEL
    yield Motion, OF_SECTIONS["body"]["motion"]
    yield Contact, OF_TOP_LEVEL["contact"]
    for name, kind in SECTIONS.items():
        if name != "parameters":
            for table in kind.tables.values() if isinstance(kind, Kinds) else [kind]:
                yield table, OF_SECTIONS[name]


def test_every_number_has_a_unit_or_none_to_have():
    missing = {
        f"{table.__name__}.{key}"
        for table, specs in tables()
        for key, field in table.model_fields.items()
        if key not in specs and key not in PLAIN
        if re.search(r"\b(float|int|ndarray|Any)\b", re.sub(r"'.*?'", "", str(field.annotation)))
        if key not in SECTIONS and key != "contact"
    }
    assert missing == set()


def units_of(spec):
    if isinstance(spec, MeasuredColumns):
        return {unit for unit in spec.columns if unit is not None}
    return {spec.unit, spec.plane or spec.unit}


def test_descriptions_name_the_unit_of_plain_numbers():
    for table, specs in tables():
        for key, field in table.model_fields.items():
            spec = specs.get(field.alias or key)
            if isinstance(spec, Measured | MeasuredColumns):
                words = [word for unit in units_of(spec) for word in unit.factors]
                text = re.sub("[,:;)]", " ", f"{field.description} ")
                assert any(f"{word} " in text for word in words), (table, key)


def measured(specs, keys=()):
    """Each key that measures something, as a path of keys."""
    for key, spec in specs.items():
        if isinstance(spec, dict):
            yield from measured(spec, (*keys, key))
        else:
            yield (*keys, key), spec


def nested(keys, value):
    for key in reversed(keys):
        value = {key: value}
    return value


def converted(keys, value, dim):
    table = in_own_units({"dim": dim} | nested(keys, value), Where([]))
    for key in keys:
        table = table[key]
    return table


PATHS = list(measured(OF_TOP_LEVEL)) + [
    ((section, "name", *keys), spec)
    for section, specs in OF_SECTIONS.items()
    for keys, spec in measured(specs)
]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("keys", "spec"), PATHS, ids=lambda x: ".".join(x) if x is tuple else "")
def test_every_unit_of_every_key(keys, spec, dim):
    if isinstance(spec, MeasuredColumns):
        for word, factor in spec.columns[0].factors.items():
            rows = converted(keys, [[f"3 {word}", 1], [0, "= dp"]], dim)
            assert rows == [[float(3 * factor), 1], [0, "= dp"]]
        return
    unit = spec.unit_in(dim)
    for word, factor in unit.factors.items():
        text, number = f"2.5 {word}", float(factor * 5 / 2)
        assert converted(keys, text, dim) == number
        assert converted(keys, [text, 1], dim) == [number, 1]
        assert converted(keys, {"d2": text, "d3": "= dp"}, dim) == {"d2": number, "d3": "= dp"}


def test_units_are_written_as_people_write_them(write):
    def dp(text):
        return load_scenario(write(), [f"dp={text}"]).dp

    assert dp("35 mm") == dp("35mm") == dp("3.5e1  mm") == dp('"3.5 cm"') == 0.035
    assert load_scenario(write("g = '9.81 m/s^2'")).g == 9.81
    assert load_scenario(write("g = '9.81 m/s²'")).g == 9.81
    assert load_scenario(write("[material.water]\nrho0 = '1.02 g/cm³'")).materials[
        "water"
    ].rho0 == pytest.approx(1020, rel=1e-15)


def test_expressions_see_numbers(write):
    parameters = """
[parameters]
depth = { value = "20 cm", min = "10 mm", unit = "m" }
width = { value = "3 cm", unit = "mm" }
bare = "40 km/h"
"""
    scenario = load_scenario(
        write('xi = "= dp + depth + width + bare"', parameters + BLOCK),
        ["dp=25 mm", "bare=36 km/h", 'time_max="= 2*time_out"', "time_out=100 ms"],
    )
    assert scenario.xi == pytest.approx(0.025 + 0.2 + 30 + 10)
    assert scenario.time_max == 0.2


def test_angles_are_degrees_and_angular_speeds_radians(write):
    scenario = load_scenario(write("slope = '20 deg'"), ["body.block.rotate=0.5 rad"])
    assert scenario.slope == 20
    assert scenario.body["block"].rotate == pytest.approx(math.degrees(0.5))
    with_motion = BLOCK + "fixed = true\nmotion = { angular_velocity = '30 rpm', pivot = [0, 0] }\n"
    motion = load_scenario(write(tables=with_motion)).body["block"].motion
    assert motion.angular_velocity == pytest.approx(math.pi)


def test_fractions_on_the_command_line(write):
    assert load_scenario(write(), ["dp=1/8"]).dp == 0.125
    assert load_scenario(write(), ["xi=1e2/1E3"]).xi == 0.1


@pytest.mark.parametrize(
    ("top", "override", "parts"),
    [
        ("g = '3 kg'", None, ["line 5", 'g = "3 kg" is not an acceleration', "m/s2"]),
        ("", "dp=3 kg", ['--set dp: dp = "3 kg" is not a length', '"25 mm"', "m, cm, mm"]),
        ("", "dp=one", ['--set dp: dp = "one" is not a length', '"= 1/60"']),
        ("", "dp=1e999 m", ["is not a length"]),
        ("", "dp=1e-999999999 m", ["is not a length"]),
        ("", "dp=3 MM", ["is not a length"]),
        ("", "body.block.velocity=['3 kg', 0]", ['body.block.velocity.0 = "3 kg" is not a speed']),
        ("time_history = '3'", None, ["time_history", "is not a time", '"20 ms"']),
        ("eta = '3 mm'", None, ["eta = '3 mm' must be a number"]),
        ("", "depth=3 kg", ['depth.value = "3 kg" is not a length']),
        ("", "depth=0.01 mm", ["parameters.depth", "out of range; must be 0.1 m or more"]),
        ("eta = 'big'\nalpha = '= 2*eta'", None, ["eta = 'big' must be a number"]),
    ],
)
def test_what_is_no_such_quantity_is_refused(write, error_of, top, override, parts):
    parameters = '\n[parameters]\ndepth = { value = 1, min = 0.1, unit = "m" }\n'
    message = error_of(write(top, parameters + BLOCK), *([override] if override else []))
    for part in parts:
        assert part in message


def test_no_two_units_share_a_word():
    words = [word for unit in UNITS for word in unit.factors]
    assert sorted({word for word in words if words.count(word) > 1}) == []
