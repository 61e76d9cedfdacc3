"""Every key of the schema, in each scheme and kind of table: it changes the run, or is refused.

A small scene is stepped with and without each value.  A key that changes neither the particles, nor
what gauges read, nor when is ignored, and no key may be.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from doseki.compiled import load_core
from doseki.driver.gauges import build_gauges
from doseki.errors import UserError
from doseki.scenario.gauges.kinds import GAUGES
from doseki.scenario.load import load_scenario
from doseki.scenario.tables.bodies import BODIES
from doseki.scenario.tables.contact import Contact
from doseki.scenario.tables.inflow import Inflow
from doseki.scenario.tables.material import MaterialTable
from doseki.scenario.tables.motion import Motion
from doseki.scenario.tables.region import Outflow
from doseki.scenario.tables.root import ScenarioTable
from doseki.scenario.tables.sections import SECTIONS
from doseki.solver.build import filled_simulation

STEPS = 15
SCHEMES = {
    "ueta2022": 'scheme = "ueta2022"\nxi = 0.05\n',
    "resolved": 'scheme = "resolved"\nspeed_max = 5\n',
}
WORDS = {"title", "description", "schema_version", "enabled", "kind", "shape"}  # that name things
# Not what a run computes: when it writes, and what is drawn of it (tests/driver, tests/figures).
OF_RECORD = {"time_max", "time_out", "time_history", *SECTIONS}
SELF_EVIDENT = {"dim", "scheme", "dp", "contact"}  # the first three are the case, the last is below

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
    path: str, prefix: str, keys: Iterable[str], values: Mapping[str, Sequence[str]]
) -> str:
    """The keys under `prefix` that change nothing and are not refused.

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


CASES = [(scheme, dim) for scheme in SCHEMES for dim in (2, 3)]
cases = pytest.mark.parametrize(("scheme", "dim"), CASES, ids=lambda value: str(value))

ROOT = {
    "kernel": ["wendland_c6", "wendland_c2"],
    "eos": ["tait"],
    "viscosity": ["monaghan_cleary"],
    "turbulence": ["smagorinsky", "mixing_length"],
    "smagorinsky": ["0.3", "0.3 with turbulence=smagorinsky"],
    "shifting": ["false"],
    "speed_max": ["8"],
    "precision": ["float"],
    "gravity": ["[1, {zeros}-5]"],
    "slope": ["10"],
    "g": ["5 with slope=10", "5 with gravity=[0, {zeros}0]; xi_height=0.3"],
    "attraction": ["2"],
    "eta": ["1.35"],
    "alpha": ["0.5"],
    "balsara": ["false"],
    "strength": ["false"],
    "tension": ["free", "clamp_all"],
    "h_mode": ["eq10"],
    "sym_grad": ["true with h_mode=eq10"],
    "cflnumber": ["0.05"],
    "cfl_force": ["0.001"],
    "xi": ["0.07"],
    "xi_height": ["0.7"],
    "fixed_limits_dt": ["false"],
    "skin": ["0.2"],
    "periodic": ['["x"] with domain_min=[-0.3, {low}-1]; domain_max=[1.6, {high}1]'],
    "domain_min": ["[-0.4, {low}-1]"],
    "domain_max": ["[1.7, {high}1]"],
}  # fmt: skip


@cases
def test_the_top_level(tmp_path, scheme, dim):
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, BLOCK))
    middle = (
        {"zeros": "0, ", "low": "-1, ", "high": "1, "}
        if dim == 3
        else dict.fromkeys(("zeros", "low", "high"), "")
    )
    values = {key: [v.format(**middle) for v in entries] for key, entries in ROOT.items()}
    keys = set(ScenarioTable.model_fields) - WORDS - OF_RECORD - SELF_EVIDENT
    assert ignored(str(path), "", sorted(keys), values) == NONE


BLOCK = """
[body.block]
shape = "box"
material = "rock"
min = [0.6, @00]
max = [1.0, @10.4]
velocity = [-1, @00]
"""
ELASTIC = 'kinematics = "elastic"\n'
FIXED = "fixed = true\n"
SUBJECTS = {  # tables [body.subject]: what they say beside material
    "box": ('shape = "box"\nmin = [0.6, @00]\nmax = [1.0, @10.4]\n', "box"),
    "ball": ('shape = "{ball}"\ncentre = [0.9, @10.25]\nradius = 0.25\n', "disc"),
    "one": ('shape = "{ball}"\ncentre = [0.7, @10.1]\nradius = 0.1\nfill = "single"\n', "disc"),
    "packed": (
        'shape = "{ball}"\nd = 0.2\nmin = [0.6, @00]\nmax = [1.3, @+0.5]\n'
        "count = 3\npacking = 0.4\n",
        "grains",
    ),
    "polygon": ('shape = "polygon"\nvertices = [[0.6, 0], [1.1, 0], [0.6, 0.4]]\n', "polygon"),
    "points": ('shape = "points"\nposition = [[0.7, @10.2], [1.0, @10.2]]\nmass = 20\n', "points"),
}
BODY = {
    "material": ["basalt with material.rock.rho0=2000", "water"],
    "pressure": ["500"],
    "fixed": ["true", "false"],
    "motion": ["{ velocity = [1, {zeros}0] }"],
    "velocity": ["[-0.5, {zeros}0.1]"],
    "wall": ["free_slip", "rough"],
    "ks": ["0.01", "0.01 with body.subject.wall=rough; body.subject.ks=0.02"],
    "normal": ["[-1, {zeros}0]"],
    "kinematics": ["elastic", "single", "rigid with body.subject.kinematics=elastic"],
    "clamped": ["= x - 0.85"],
    "displacement": ['["= 0.02*x", {zeros}0]'],
    "elastic_law": ["neo_hookean"],
    "damping": ["0.5"],
    "hourglass": ["0.1"],
    "spin": ["{spin}"],
    "dp": ["0.05", "0.05 with body.subject.kinematics=single"],
    "rotate": ["20", "20 with body.subject.displacement=['= 0.02*x', {zeros}0]"],
    "rotate_axis": ["[0, 1, 1]", "[0, 1, 1] with body.subject.rotate=30"],
    "pivot": ["[0.6, {zeros}0.5]", "[0.6, {zeros}0.5] with body.subject.rotate=20"],
    "mass_per_particle": ["{mass}"],
    "jitter": ["0.3"],
    "random_seed": ["7", "7 with body.subject.jitter=0.3"],
    "where": ["= x - 0.85"],
    "min": ["[0.7, {zeros}0]"],
    "max": ["[1.2, {middle}0.6]"],
    "count": ["2"],
    "wetted_by": ["water"],
    "centre": ["[0.85, {middle}0.3]"],
    "radius": ["0.2"],
    "fill": ["single", "lattice"],
    "d": ["0.15"],
    "grading": ["[[0.1, 1], [0.15, 1]]"],
    "mass_total": ["100"],
    "width": ["0.4", "0.4 with body.subject.mass_total=100"],
    "packing": ["0.3"],
    "wetted": ["0.8"],
    "settle": ["true", "0.05"],
    "vertices": ["[[0.7, 0.1], [1.1, 0], [0.9, 0.4]]"],
    "position": ["[[0.85, {middle}0.2]]"],
    "mass": ["25"],
}  # fmt: skip


@cases
@pytest.mark.parametrize("way", ["free", "fixed", "elastic"])
@pytest.mark.parametrize("subject", SUBJECTS)
def test_bodies(tmp_path, subject, scheme, dim, way):
    keys, kind = SUBJECTS[subject]
    also = {"free": "", "fixed": FIXED, "elastic": ELASTIC}[way]
    text = text_of(scheme, dim, f'[body.subject]\nmaterial = "rock"\n{keys}{also}')
    path = tmp_path / "case.toml"
    path.write_text(text.replace("{ball}", "disc" if dim == 2 else "sphere"))
    if outcome(str(path), ()) == REFUSED:
        pytest.skip("no such body in this scheme and dimension")
    words = {
        "zeros": "0, " if dim == 3 else "",
        "middle": "0.3, " if dim == 3 else "",
        "spin": "[0, 2, 1]" if dim == 3 else "2",
        "mass": "2" if dim == 3 else "20",
    }
    values = {key: [replaced(v, words) for v in entries] for key, entries in BODY.items()}
    if subject == "one":
        del values["kinematics"][1]  # single, which fill says already
        del values["ks"][1]  # friction needs a surface of several
    fields = set(BODIES.tables[kind].model_fields) - WORDS
    assert ignored(str(path), "body.subject.", sorted(fields), values) == NONE


@cases
def test_particles_of_files(tmp_path, scheme, dim):
    particles = "x,y,vx,vy,mass,density" if dim == 2 else "x,y,z,vx,vy,vz,mass,density"
    row = "0.7,0.2,0,0,20,1000" if dim == 2 else "0.7,0.1,0.2,0,0,0,2,1000"
    for name, more, values in (("plain", "", ""), ("full", ",material,fixed", ",water,0")):
        (tmp_path / f"{name}.csv").write_text(f"{particles}{more}\n{row}{values}\n")
    for name in ("plain", "full"):
        path = tmp_path / f"{name}.toml"
        also = 'material = "water"\n' if name == "plain" else ""
        table = f'[body.subject]\nshape = "file"\nfile = "{name}.csv"\n{also}'
        path.write_text(text_of(scheme, dim, table))
        other = "full" if name == "plain" else "plain"
        values = {
            "file": [str(tmp_path / f"{other}.csv")],
            "digest": ["0" * 32],
            "fixed": ["true"],
            "material": ["rock"],
        }
        fields = sorted(set(BODIES.tables["file"].model_fields) - WORDS - {"file"})
        assert outcome(str(path), ()) != REFUSED
        assert ignored(str(path), "body.subject.", fields, values) == NONE


MOTION = {
    "velocity": ["[0, {zeros}1]"],
    "angular_velocity": ["{spin} with {m}.pivot=[0.6, {zeros}0]", "{spin}"],
    "pivot": [
        "[0.6, {zeros}0.2]",
        "[0.6, {zeros}0.2] with {m}.angular_velocity={spin}; {m}.pivot=[0.6, {zeros}0]",
    ],
    "start": ["0.0005"],
    "stop": ["0.0005"],
    "removed_at": ["0.0005"],
}


@cases
@pytest.mark.parametrize("moves", ["velocity = [0.5, @00]", "removed_at = 0.9"])
def test_motions(tmp_path, scheme, dim, moves):
    table = f"{BLOCK.replace('block', 'subject').replace('velocity', '# ')}fixed = true\n"
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, f"{table}motion = {{ {moves} }}\n"))
    m = "body.subject.motion"
    words = {"m": m, "zeros": "0, " if dim == 3 else "", "spin": "[0, 2, 1]" if dim == 3 else "2"}
    values = {key: [replaced(v, words) for v in entries] for key, entries in MOTION.items()}
    assert outcome(str(path), ()) != REFUSED
    assert ignored(str(path), f"{m}.", sorted(Motion.model_fields), values) == NONE


FLOWS = {
    "material": ["mud"],
    "rate": ["0.09"],
    "hydrograph": ["[[0, 0.1], [1, 0]]"],
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
    values = {key: [replaced(v, words) for v in entries] for key, entries in FLOWS.items()}
    assert outcome(str(path), ()) != REFUSED
    for section, table in (("inflow", Inflow), ("outflow", Outflow)):
        keys = sorted(set(table.model_fields) - WORDS)
        assert ignored(str(path), f"{section}.subject.", keys, values) == NONE


# Overlap is also what may lie over one another at the start; a scenario that names the speed may
# be run with either stiffness.
CONTACT = {
    "law": ["hertz"],
    "overlap": ["0.05"],
    "speed": ["2"],
    "stiffness": ["material"],
    "steps": ["40"],
}
MATERIAL = {
    "law": ["{other}"],
    "rheology": ["herschel_bulkley"],
    "based_on": ["aluminium", "mud"],
    "rho0": ["2000"],
    "speedsound": ["3000 with xi=0.05"],
    "shear_modulus": ["1e9"],
    "nu": ["1e-2"],
    "yield_strength": ["10"],
    "cohesion": ["10"],
    "friction_angle": ["10"],
    "yield_stress": ["5", "5 with {hb}"],
    "consistency": ["5", "5 with {hb}"],
    "flow_index": ["0.5", "0.5 with {hb}"],
    "regularisation": ["0.5", "0.5 with {hb}"],
    "viscosity_max": ["0.5", "0.5 with {hb}"],
    "casson_viscosity": ["5", "5 with {casson}"],
    "mu_s": ["0.5", "0.5 with {mu}"],
    "mu_2": ["0.9", "0.9 with {mu}"],
    "inertial_number": ["0.5", "0.5 with {mu}"],
    "grain_diameter": ["0.02", "0.02 with {mu}"],
    "grain_density": ["2000", "2000 with {mu}"],
    "gamma": ["5", "5 with eos=stiffened_gas"],
    "restitution": ["0.2"],
    "friction": ["0.1"],
    "rolling_friction": ["0.3"],
    "young_modulus": ["1e6"],
    "poisson_ratio": ["0.4"],
}
# What softened contacts do not ask for, and elastic bodies and other contacts do.
ELASTICITY = ("shear_modulus", "speedsound", "young_modulus", "poisson_ratio")
LAWS = {
    "hb": "rheology=herschel_bulkley; yield_stress=1; consistency=1; regularisation=0.1;"
    " viscosity_max=50",
    "casson": "rheology=casson; yield_stress=1; casson_viscosity=1; regularisation=0.1;"
    " viscosity_max=50",
    "mu": "rheology=mu_i; mu_s=0.3; mu_2=0.6; inertial_number=0.3; grain_diameter=0.01;"
    " grain_density=2500; viscosity_max=50",
}
# Two rocks that touch each other and the floor, askew.
ROCKS = """
[body.one]
shape = "{ball}"
material = "rock"
centre = [1.0, @10.2495]
radius = 0.25
velocity = [1, @0-1]
[body.two]
shape = "{ball}"
material = "rock"
centre = [1.4, @10.5485]
radius = 0.25
velocity = [-1, @00]
"""


@cases
def test_contacts_and_materials(tmp_path, scheme, dim):
    path = tmp_path / "case.toml"
    tables = '[material.mud]\nbased_on = "water"\n' + ROCKS
    text = text_of(scheme, dim, tables).replace("{ball}", "disc" if dim == 2 else "sphere")
    path.write_text(text)
    assert outcome(str(path), ()) != REFUSED
    assert ignored(str(path), "contact.", sorted(Contact.model_fields), CONTACT) == NONE
    for material in ("water", "rock"):
        prefix = f"material.{material}."
        laws = {"other": "solid" if material == "water" else "fluid"}
        laws |= {k: prefix + v.replace("; ", f"; {prefix}") for k, v in LAWS.items()}
        values = {key: [replaced(v, laws) for v in entries] for key, entries in MATERIAL.items()}
        if scheme == "resolved":
            for key in ELASTICITY:
                also = "; " if " with " in values[key][0] else " with "
                values[key] = [f"{values[key][0]}{also}contact.stiffness=material"]
        assert ignored(str(path), prefix, sorted(MaterialTable.model_fields), values) == NONE


GAUGE = {
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
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, f'{FAR}[gauge.g]\nkind = "{kind}"\n{"".join(needed)}'))
    if outcome(str(path), ()) == REFUSED:
        pytest.skip("no such gauge in this scheme")
    words = {"zeros": "0, " if dim == 3 else ""}
    values = {key: [replaced(v, words) for v in entries] for key, entries in GAUGE.items()}
    keys = sorted(set(table.model_fields) - WORDS)
    assert ignored(str(path), "gauge.g.", keys, values) == NONE


def replaced(text: str, words: Mapping[str, str]) -> str:
    """The text with {word} replaced; other braces are those of TOML."""
    for word, entry in words.items():
        text = text.replace("{" + word + "}", entry)
    return text
