"""What a scenario means: gravity, xi, materials, choices by dimension, extension, round trip."""

import copy
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from doseki.scenario.load import load_scenario
from doseki.scenario.values.toml_source import TomlSource, read_toml
from doseki.scene.build import build_bodies
from doseki.util.toml_writer import to_toml

from ..small_scenarios import BLOCK


def test_slope_gives_gravity_down_x_and_into_the_bed(write):
    gravity = load_scenario(write("slope = 30\ng = 10")).gravity
    np.testing.assert_allclose(gravity, [-5, -10 * np.sqrt(0.75)])
    flat = load_scenario("flume", ["dim=3", "slope=0"]).gravity
    np.testing.assert_allclose(flat, [0, 0, -9.8])


def test_xi_from_a_height_uses_the_slowest_material_in_use(write):
    basalt = BLOCK.replace("block", "rock").replace("water", "basalt")
    assert load_scenario(write()).xi == 1
    assert load_scenario(write("xi_height = 2")).xi == pytest.approx(0.04472, rel=1e-3)
    only_rock = load_scenario(write("xi_height = 2", basalt))
    assert only_rock.xi == pytest.approx(10 * np.sqrt(2 * 9.8 * 2) / 3116)
    assert only_rock.material_names == ["basalt"]


def test_materials_of_table_1_scale_with_xi():
    materials = load_scenario("flume").materials
    assert (materials["water"].speedsound, materials["water"].nu) == (1400, 1e-6)
    scaled = materials["basalt"].scaled(0.05)
    assert scaled.speedsound == pytest.approx(155.8)
    assert scaled.shear_modulus == pytest.approx(56.75e6)
    assert scaled.rho0 == 2750
    assert materials["aluminium"].shear_modulus == 25.5e9


def test_new_material_is_based_on_another(write):
    tables = BLOCK.replace("water", "mud") + "[material.mud]\nbased_on = 'water'\nnu = 1e-3\n"
    mud = load_scenario(write(tables=tables)).materials["mud"]
    assert (mud.law, mud.rho0, mud.nu) == ("fluid", 1000, 1e-3)


def test_disabled_parts_are_not_there(write):
    off = BLOCK.replace("block", "lid") + 'enabled = "= dim == 3"\nfoo = 1\n'
    assert list(load_scenario(write(tables=BLOCK + off)).body) == ["block"]


def test_a_byte_order_mark_is_passed_over(write, tmp_path):
    marked = tmp_path / "marked.toml"
    marked.write_text("\ufeff" + Path(write()).read_text(), encoding="utf-8")
    assert load_scenario(marked).dp == 0.1
    assert read_toml(marked).line_of(("dim",)) == 1


def test_extension_overrides_table_by_table(write, tmp_path):
    write("xi = 0.1\nalpha = 2", name="base.toml")
    over = tmp_path / "over.toml"
    over.write_text('extends = "base.toml"\nxi_height = 1\n[body.block]\nvelocity = [1, 2]\n')
    scenario = load_scenario(str(over))
    assert scenario.alpha == 2
    assert scenario.xi == pytest.approx(10 * np.sqrt(19.6) / 1400)
    assert scenario.body["block"].velocity == [1, 2]
    assert scenario.body["block"].material == "water"


@pytest.mark.parametrize("name", ["collision", "flume-strength", "shear-wave", "dambreak"])
@pytest.mark.parametrize("dim", [2, 3])
def test_effective_scenario_reads_back_to_the_same_run(tmp_path, name, dim):
    scenario = load_scenario(name, [f"dim={dim}"])
    path = tmp_path / "effective.toml"
    path.write_text(scenario.effective_toml())
    again = load_scenario(str(path))
    assert again.effective_toml() == scenario.effective_toml()
    assert again.xi == scenario.xi
    np.testing.assert_array_equal(again.gravity, scenario.gravity)
    first, names = build_bodies(scenario)
    second, same_names = build_bodies(again)
    assert names == same_names
    for key, values in vars(first).items():
        np.testing.assert_array_equal(values, getattr(second, key))


@pytest.mark.parametrize(
    ("keys", "line"),
    [(("a",), 1), (("b", "c"), 3), (("b", "d", "e"), 5), (("b", "missing"), 2), (("x",), None)],
)
def test_line_of_a_key(tmp_path, keys, line):
    text = "a = 1\n[b]\nc = 2\n[b.d]\ne = { f = 3 }\n"
    assert TomlSource(tmp_path, text, {}).line_of(keys) == line


PLAIN = st.one_of(
    st.booleans(),
    st.integers(-(2**60), 2**60),
    st.floats(allow_nan=False),
    st.text(st.characters(exclude_categories=["Cs"]), max_size=8),
)
TABLES = st.recursive(
    st.dictionaries(st.text("ab c.é\"'\n", max_size=4), PLAIN | st.lists(PLAIN, max_size=3)),
    lambda inner: st.dictionaries(st.text("ab c", max_size=3), inner | PLAIN, max_size=3),
    max_leaves=6,
)


def _without_empty_tables(table):
    kept = {k: _without_empty_tables(v) if isinstance(v, dict) else v for k, v in table.items()}
    return {k: v for k, v in kept.items() if v != {}}


@settings(max_examples=60)
@given(TABLES)
def test_written_toml_reads_back(table):
    assert tomllib.loads(to_toml(table)) == _without_empty_tables(table)


def test_a_loaded_scenario_does_not_change(write):
    scenario = load_scenario(write())
    for table, key in ((scenario, "xi"), (scenario.body["block"], "material")):
        with pytest.raises(ValidationError, match="frozen"):
            setattr(table, key, None)


def test_dictionaries_of_a_loaded_scenario_do_not_change(write):
    scenario = load_scenario(write())
    for tables in (scenario.body, scenario.gauge, scenario.materials, scenario.constants):
        for change in (
            lambda tables=tables: tables.update(other=1),
            lambda tables=tables: tables.__setitem__("other", 1),
            lambda tables=tables: tables.pop("block", None),
            lambda tables=tables: tables.clear(),
        ):
            with pytest.raises(TypeError, match="does not change"):
                change()
    copied = copy.deepcopy(scenario)
    assert copied.effective_toml() == scenario.effective_toml()


def test_another_xi_makes_another_scenario(write):
    given = load_scenario(write("xi = 0.1"))
    other = given.with_xi(0.2)
    assert (given.xi, other.xi) == (0.1, 0.2)
    assert other.materials == given.materials
    assert other.effective_toml() == given.effective_toml().replace("xi = 0.1", "xi = 0.2")
