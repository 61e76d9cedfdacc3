"""Every key of a body, of each shape and way to move, changes the run or is refused (walk.py)."""

from __future__ import annotations

import pytest
from trimesh.creation import box as box_of_triangles

from doseki.scenario.tables.bodies import BODIES
from doseki.scenario.tables.motion import Motion

from .walk import BLOCK, NONE, REFUSED, WORDS, cases, ignored, outcome, replaced, text_of

ELASTIC = 'kinematics = "elastic"\n'
FIXED = "fixed = true\n"
SUBJECTS = {  # tables [body.subject]: what they say beside material
    "box": ('shape = "box"\nmin = [0.6, @00]\nmax = [1.0, @10.4]\n', "box"),
    "ball": ('shape = "{ball}"\ncentre = [0.87, @10.25]\nradius = 0.25\n', "disc"),
    "one": ('shape = "{ball}"\ncentre = [0.7, @10.1]\nradius = 0.1\nfill = "single"\n', "disc"),
    "packed": (
        'shape = "{ball}"\nd = 0.2\nmin = [0.6, @00]\nmax = [1.3, @+0.5]\n'
        "count = 3\npacking = 0.4\n",
        "grains",
    ),
    "polygon": ('shape = "polygon"\nvertices = [[0.6, 0], [1.1, 0], [0.6, 0.4]]\n', "polygon"),
    "stl": ('shape = "stl"\nfile = "cube.stl"\nscale = 0.4\ncentre = [0.8, 0.3, 0.2]\n', "stl"),
    "mesh": (
        'shape = "mesh"\nfile = "cube.stl"\nscale = 0.4\nposition = [0.8, 0.3, 0.2]\n',
        "mesh",
    ),
    "tank": ('shape = "tank"\nmin = [-0.3, @-0]\nmax = [1.6, @+0.6]\n', "tank"),
    "points": ('shape = "points"\nposition = [[0.7, @10.2], [1.0, @10.2]]\nmass = 20\n', "points"),
}
BODY = {
    "array": ["{ count = {copies}, step = [1, {zeros}0] }", "{ mirror = 'x', at = -1 }"],
    "material": ["basalt with material.rock.rho0=2000", "water"],
    "pressure": ["500"],
    "fixed": ["true", "false"],
    "motion": ["{ velocity = [1, {zeros}0] }"],
    "velocity": ["[-0.5, {zeros}0.1]"],
    "wall": ["free_slip", "rough", "voellmy"],
    "ks": ["0.01", "0.01 with {rough}"],
    "mu": ["0.4", "0.4 with {voellmy}"],
    "turbulent_xi": ["1", "1 with {voellmy}"],
    "normal": ["[-1, {zeros}0]"],
    "kinematics": ["elastic", "single", "rigid with body.subject.kinematics=elastic"],
    "clamped": ["= x - 0.85"],
    "displacement": ['["= 0.02*x", {zeros}0]'],
    "elastic_law": ["neo_hookean"],
    "damping": ["0.5"],
    "hourglass": ["0.1"],
    "flaw_seed": ["2"],
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
    "file": ["{folder}/slab.stl"],
    "digest": ["0" * 32],
    "scale": ["0.45"],
    "thickness": ["0.2"],
    "sheet": ["true"],
    "open": ['["-x"]'],
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
    for name, height in (("cube", 1), ("slab", 0.8)):
        box_of_triangles((1, 1, height)).export(tmp_path / f"{name}.stl")
    if outcome(str(path), ()) == REFUSED:
        pytest.skip("no such body in this scheme and dimension")
    words = {
        "zeros": "0, " if dim == 3 else "",
        "middle": "0.3, " if dim == 3 else "",
        "spin": "[0, 2, 1]" if dim == 3 else "2",
        "mass": "2" if dim == 3 else "20",
        "copies": "[2, 1, 1]" if dim == 3 else "[2, 1]",
        "folder": str(tmp_path),
        "voellmy": "body.subject.wall=voellmy; body.subject.mu=0.2",
        "rough": "body.subject.wall=rough; body.subject.ks=0.02; turbulence=mixing_length",
    }
    values = {key: [replaced(v, words) for v in entries] for key, entries in BODY.items()}
    if subject == "one":
        del values["kinematics"][1]  # single, which fill says already
        for key in ("ks", "mu", "turbulent_xi"):
            del values[key][1]  # friction needs a surface of several
    if subject in ("tank", "mesh"):
        del values["fixed"][0]  # it is
    if subject == "mesh":
        values["position"] = ["[0.85, 0.3, 0.2]"]
        values["thickness"] = ["0.2 with body.subject.sheet=true", "0.2"]
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
