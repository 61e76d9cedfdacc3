"""Wrong scenarios: one sentence that names file, line, key, value, and what is allowed."""

import pytest

from doseki.errors import ResourceError, UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies

from ..small_scenarios import BLOCK


@pytest.mark.parametrize(
    ("top", "parts"),
    [
        ("alhpa = 1", ["case.toml, line 5", "alhpa is not a known key", "did you mean alpha?"]),
        ("alpha = -1", ["line 5", "alpha = -1 is out of range", "at least 0"]),
        ('alpha = "big"', ["line 5", "alpha = 'big' must be a number"]),
        ("alpha = true", ["alpha = true must be a number"]),
        ("alpha = nan", ["alpha = nan must be finite"]),
        ("alpha = inf", ["alpha = inf must be finite"]),
        ("balsara = 1", ["balsara = 1 must be true or false"]),
        ('tension = "fre"', ["tension = 'fre' is not allowed", "'free'", "'clamp_all'"]),
        ("eta = 30", ["eta = 30 is out of range", "at most 3"]),
        ("gravity = [0, -9.8, 0]", ["a 2-D run needs 2 entries here, not 3"]),
        ("gravity = 9.8", ["gravity = 9.8 must be a list in square brackets"]),
        ("alpha = 2020-01-01", ["line 5", "alpha = 2020-01-01 must be a number"]),
        ("alpha = { a = [1] }", ["alpha = { a = [1] } must be a number"]),
        ("alpha = 1" + "0" * 400, ["alpha = 1000000000... (401 digits) is out of range"]),
        (f"title = '{'a' * 301}'", ["line 5", "has 301 characters; at most 300 are allowed"]),
        (
            "[figure.f]\nkind = 'snapshot'\ncolour = []",
            ["figure.f.colour = [] has 0 entries; at least 1 is needed"],
        ),
        (
            "[figure.f]\nkind = 'snapshot'\ntimes = [" + "1, " * 25 + "]",
            ["line 7", "has 25 entries; at most 24 are allowed"],
        ),
        ("gravity = { d3 = [0, 0, 0] }", ["gravity has no value for a 2-D run (d2 is missing)"]),
        ("gravity = [0, 0]\nslope = 20", ["gravity and slope exclude each other"]),
        ("xi = 0.1\nxi_height = 2", ["xi and xi_height exclude each other"]),
        ("hdp = 1.2\neta = 1.2", ["hdp and eta are the same thing"]),
        ('periodic = ["x"]', ["periodic needs domain_min and domain_max"]),
        ('periodic = ["z"]', ['a 2-D run has no axis "z"']),
        (
            'periodic = ["x"]\ndomain_min = [0, 0]\ndomain_max = [0.5, 1]',
            ["line 7", "0.5 m long along x", "twice the support of a particle, 0.6 m"],
        ),
        (
            'periodic = ["x"]\ndomain_min = [0, 0]\ndomain_max = [0.9, 1]',
            ["body.block", "x = 0.95 m lies outside the periodic domain"],
        ),
        ('alpha = "= 2*bta"', ["alpha:", "unknown name bta"]),
        ('alpha = "= x"', ["unknown name x"]),
        ('alpha = "= eta"\neta = "= alpha"', ["depends on itself"]),
        ("time_history = 1e-9", ["time_history = 1e-09 s is too short for time_max = 1 s"]),
        ("schema = 2", ["schema = 2 is not allowed; choose 1"]),
        (
            "[parameters]\neta = 3",
            ["parameters.eta", "another meaning, the key eta of a scenario ("],
        ),
        ("[parameters]\nstrength = 3", ["another meaning, the key strength of a scenario ("]),
        ("[parameters]\nbody = 3", ["parameters.body", "another meaning, the table [body]"]),
        ("[parameters]\nmaps = 3", ["parameters.maps", "another meaning, the table [maps]"]),
        ("[parameters]\ndef = 3", ["parameters.def", "a word of the language of expressions"]),
        ("[parameters]\npi = 3", ["parameters.pi", "a constant in expressions; choose another"]),
        ("[parameters]\nmax = 3", ["parameters.max", "a function in expressions"]),
        ("[parameters]\nz = 3", ["parameters.z", "a coordinate in expressions"]),
        ("[parameters]\nn = { value = 7, choices = [1, 5] }", ["7 is not one of 1, 5"]),
        (
            "[parameters]\nn = { value = 0, min = 1 }",
            ["parameters.n: 0 is out of range", "be 1 or more"],
        ),
        ("[parameters]\nn = { value = 2, max = 1 }", ["parameters.n: 2 is out", "be 1 or less"]),
        ("[parameters]\nn = { valu = 0 }", ["parameters.n.valu is not a known key"]),
        ("[parameters]\nn = {}", ["parameters.n.value is missing"]),
        ("[material.mud]\nlaw = 'fluid'", ["material.mud", "needs rho0, speedsound"]),
        ("[material.mud]\nbased_on = 'watr'", ['based_on = "watr" is not a material']),
        ("[material.mud]\nbased_on = 'mud'", ["leads back to the material itself"]),
        ("[material.water]\nrho0 = 0", ["material.water.rho0 = 0", "greater than 0"]),
        ("[material.water]\nvisc = 1", ["material.water.visc is not a known key"]),
        (
            "[figure.f]\nkind = 'snapshot'\nwindow = 'w'",
            ['figure.f.window = "w" is not a known window'],
        ),
        ("[figure.f]\nkind = 'snapshot'\ncolour = ['sped']", ["line 7", "did you mean speed?"]),
        ("[figure.f]", ["figure.f.kind is missing"]),
        ("[window.w]\nmin = [0, 0]\nmax = [1, 0]", ["every entry of min must be below"]),
        ("[outflow.o]\nmin = [0, nan]\nmax = [1, 'inf']", ["nan is not a position"]),
    ],
)
def test_top_level(write, error_of, top, parts):
    message = error_of(write(top))
    for part in parts:
        assert part in message


BODY = "[body.b]\nshape = 'box'\nmaterial = 'water'\nmin = [0, 0]\nmax = [1, 1]\n"


@pytest.mark.parametrize(
    ("tables", "parts"),
    [
        ("", ["at least one [body.NAME] or [inflow.NAME]"]),
        ("[body.b]\nmaterial = 'water'", ["body.b.shape is missing", "box, disc"]),
        ("[body.b]\nshape = 'bx'", ['body.b.shape = "bx" is not a shape', "did you mean box?"]),
        ("[body.b]\nshape = 'box'\nmaterial = 'water'\nmin = [0, 0]", ["body.b.max is missing"]),
        (BODY + "radius = 1", ["line 11", "body.b.radius is not a known key"]),
        (BODY + "rotat = 1", ["did you mean rotate?"]),
        (BODY.replace("'water'", "'watr'"), ['"watr" is not a known material', "water?"]),
        (BODY + "count = 101", ["body.b.count = 101: the box holds only 100 particles"]),
        (BODY + "count = 1.5", ["must be a whole number"]),
        (
            BODY.replace("max = [1, 1]", "max = [1, -1]"),
            ["body.b.max = [1.0, -1.0]", "-1 m along y is not above 0 m of min"],
        ),
        (BODY + "dp = 3", ["less than one particle thick"]),
        (BODY + "velocity = [1]", ["body.b.velocity: a 2-D run needs 2 entries here, not 1"]),
        (BODY + "velocity = [1, 'fast']", ['velocity.1 = "fast" is not a speed']),
        (BODY + "velocity = [1, '= 1/x*z']", ["body.b.velocity", "unknown name z"]),
        (BODY + "rotate = 10\nrotate_axis = [0, 0]", ["rotate_axis", "only a 3-D run"]),
        (BODY + "mass_per_particle = 1e-300", ["body.b: a mass of 1e-300 kg"]),
        (BODY + "enabled = 'no'", ["body.b.enabled = 'no' must be true or false"]),
        ("[body]\nb = 3", ["body.b = 3 must be a table"]),
        ("body = 3", ["body = 3 must be a table"]),
        (
            BODY.replace("[body.b]", "[[body.b]]"),
            ["line 6", "body.b must be a table; write [body.b], where [[body.b]] makes a list"],
        ),
    ],
)
def test_bodies(write, error_of, tables, parts):
    message = error_of(write(tables=tables))
    for part in parts:
        assert part in message


INFLOW = """
[inflow.i]
material = "water"
rate = "3 L/s"
width = 0.1
position = [0, 0]
direction = [1, 0]
depth = 0.4
duration = 1
"""


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ('"3 L/s"', '"3 gal/s"', "is not a rate; allowed: a number in m3/s or a string"),
        ('"3 L/s"', "0", "inflow.i.rate = 0 is out of range; must be greater than 0"),
        ("[1, 0]", "[0, 0]", "direction must not be the zero vector"),
        ("depth = 0.4", "depth = 0.01", "less than one particle"),
        ('"water"', '"watr"', '"watr" is not a known material'),
        ("duration = 1", "", "inflow.i.duration is missing"),
    ],
)
def test_inflows(write, error_of, old, new, part):
    assert part in error_of(write(tables=BLOCK + INFLOW.replace(old, new)))


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (b"dim = 2\ndp = = 3\n", "not valid TOML: Invalid value (at line 2"),
        (bytes(range(256)), "line 2: not a text file in UTF-8"),
        ("title = 'é'".encode("latin-1"), "line 1: not a text file in UTF-8"),
        (b"a = " + b"[" * 100_000, "case.toml: tables or lists nested more than 32 deep"),
        (b"\na = " + b"1" * 5000, "case.toml, line 2: a whole number of more than 4300 digits"),
        (b"dp = 1\ndp = 2", "case.toml, line 2: dp is given twice, at first in line 1"),
        (b"[[a]]\nb = 1\n[[a]]\nb = 1\nb = 2", "line 5: a.b is given twice, at first in line 4"),
        (b"[a]\nb = 1\n[a]", "case.toml, line 3: a is given twice, at first in line 1"),
        (b"[a]\nb = 1\n[a.b]", "case.toml, line 3: a.b is given twice, at first in line 2"),
        (b"a = 1\n[a.b]", "case.toml, line 2: a.b does not go with a in line 1; give one"),
        (b"", "dim is missing"),
        (b"dim = 4", "dim = 4 is not allowed; choose 2 or 3"),
        (b"dim = 2", "dp is missing (particle spacing, m)"),
        (b"extends = 3", "extends = 3 must be the name or path"),
        (b"extends = 'flum'", 'no scenario named "flum"; did you mean flume?'),
        (b"extends = 'case.toml'", "leads back to the file itself"),
        (b"extends = 'nowhere.toml'", 'case.toml: extends = "nowhere.toml": '),
        (b"dim = 2\ndp = 1\nthreads = 2", "an option of the command, --threads"),
    ],
)
def test_files(tmp_path, error_of, content, part):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    assert part in error_of(str(path))


def test_places_that_are_no_file(tmp_path, error_of):
    assert "a folder; what is asked for is a scenario, a TOML file" in error_of(f"{tmp_path}/")
    (tmp_path / "scenario.toml").touch()
    assert f"that of this run is {tmp_path}/scenario.toml" in error_of(f"{tmp_path}")
    assert "no such file" in error_of(str(tmp_path / "none.toml"))
    assert "not a regular file" in error_of("/dev/null")
    assert "did you mean collision?" in error_of("colision")


def test_line_is_that_of_the_file_that_sets_the_key(write, tmp_path, error_of):
    write(name="base.toml", top="alpha = -1")
    over = tmp_path / "over.toml"
    over.write_text('extends = "base.toml"\neta = 1.1\n')
    assert "base.toml, line 5: alpha = -1" in error_of(str(over))


@pytest.mark.parametrize("override", ["dp=1e-9", "body.block.max=[1e9, 1e9]"])
def test_too_many_particles(write, override):
    short = ["time_max=1e-6", "time_out=1e-6"]  # the number of steps is not what is too large
    scenario = load_scenario(write(), [override, *short])
    with pytest.raises(ResourceError, match="increase dp"):
        build_bodies(scenario)


def test_errors_carry_exit_codes():
    assert (UserError.exit_code, ResourceError.exit_code) == (2, 4)


@pytest.mark.parametrize(
    ("kind", "foreign"),
    [
        ("snapshot", "bin_width = 0.1"),
        ("snapshot", 'columns = ["dt"]'),
        ("histogram", 'colour = ["speed"]'),
        ("series", 'window = "w"'),
        ("series", 'when = "last"'),
    ],
)
def test_a_figure_has_only_the_keys_of_its_kind(write, error_of, kind, foreign):
    path = write(tables=BLOCK + f'\n[figure.f]\nkind = "{kind}"\n{foreign}\n')
    assert f"figure.f.{foreign.split()[0]} is not a known key" in error_of(path)
