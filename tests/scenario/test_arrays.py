"""Parts that stand for several: lattices, files of placements, turned, mirrored copies, tanks."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.assess.preflight import check_scenario
from doseki.errors import UserError
from doseki.record.particles import FIXED
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies

HEAD = """\
dim = {dim}
dp = 0.02
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 3
"""
DISC = """
[body.post]
shape = "disc"
material = "basalt"
centre = [0.1, 0.2]
radius = 0.05
velocity = [1, 2]
spin = 3
"""
BALL = """
[body.ball]
shape = "sphere"
material = "basalt"
centre = [0.1, 0.2, 0]
radius = 0.05
"""
SHAPES = {
    "box": 'shape = "box"\nmin = [0.1, 0.2]\nmax = [0.3, 0.26]\nvelocity = [1, 2]\nspin = 2\n',
    "rotated": 'shape = "box"\nmin = [0.1, 0.2]\nmax = [0.3, 0.26]\nrotate = 25\n',
    "pivoted": (
        'shape = "box"\nmin = [0.1, 0.2]\nmax = [0.3, 0.26]\nrotate = 25\npivot = [0.2, 0]\n'
    ),
    "disc": 'shape = "disc"\ncentre = [0.1, 0.2]\nradius = 0.1\nrotate = 10\nvelocity = [1, 2]\n',
    "polygon": 'shape = "polygon"\nvertices = [[0, 0.2], [0.2, 0.2], [0.05, 0.4]]\nspin = 2\n',
    "points": 'shape = "points"\nposition = [[0.1, 0.2], [0.3, 0.1]]\nmass = 1\nfixed = true\n',
    "wall": 'shape = "box"\nmin = [0.1, 0.2]\nmax = [0.3, 0.26]\nfixed = true\nnormal = [1, 0]\n',
    "moving": (
        'shape = "box"\nmin = [0.1, 0.2]\nmax = [0.3, 0.26]\nfixed = true\n'
        "motion = { velocity = [1, 2], angular_velocity = 3, pivot = [0.1, 0.1] }\n"
    ),
}


@pytest.fixture
def load(tmp_path):
    def loaded(tables, dim=2, settings=()):
        path = tmp_path / "case.toml"
        path.write_text(HEAD.format(dim=dim) + tables)
        return load_scenario(str(path), settings)

    return loaded


def centres(scenario):
    return [body.centre.round(12).tolist() for body in scenario.body.values()]


def test_a_lattice_with_staggered_rows(load):
    lattice = 'array = { count = [2, 3], step = ["20 cm", 0.5], stagger = ["= 5*dp", 0] }\n'
    scenario = load(DISC + lattice)
    assert list(scenario.body) == [f"post.{k}" for k in range(1, 7)]
    assert centres(scenario) == [
        [0.1, 0.2], [0.3, 0.2], [0.2, 0.7], [0.4, 0.7], [0.1, 1.2], [0.3, 1.2],
    ]  # fmt: skip
    assert all(body.velocity == [1, 2] and body.array is None for body in scenario.body.values())


def test_a_lattice_of_three_dimensions(load):
    sphere = DISC.replace("disc", "sphere").replace("0.1, 0.2]", "0.1, 0.2, 0]")
    sphere = sphere.replace("spin = 3\n", "").replace("[1, 2]", "[1, 2, 0]")
    scenario = load(sphere + "array = { count = [2, 1, 2], step = [1, 1, 1] }\n", dim=3)
    assert [x[::2] for x in centres(scenario)] == [[0.1, 0], [1.1, 0], [0.1, 1], [1.1, 1]]


def test_a_file_of_placements(load, tmp_path):
    (tmp_path / "posts.csv").write_text("# posts\nx [cm], y [mm], angle\n0,0,0\n50,100,90\n")
    scenario = load(DISC + 'array = { file = "posts.csv" }\n')
    assert centres(scenario) == [[0.1, 0.2], [0.6, 0.3]]
    turned = scenario.body["post.2"]
    assert turned.rotate == 90
    np.testing.assert_allclose(turned.velocity, [-2, 1], atol=1e-15)
    (tmp_path / "posts.csv").unlink()
    (tmp_path / "again.toml").write_text(scenario.effective_toml(stored=True))
    assert centres(load_scenario(str(tmp_path / "again.toml"))) == centres(scenario)


def test_names_of_the_part_mean_all_copies(load):
    tables = DISC + "fixed = true\narray = { count = [2, 1], step = [1, 1] }\n"
    tables = tables.replace("velocity = [1, 2]\nspin = 3\n", "")
    gauges = (
        '[gauge.f]\nkind = "force"\nbodies = ["post"]\n[gauge.p]\nkind = "pressure"\n'
        "position = [0, 0]\narray = { count = [3, 1], step = [0.1, 0] }\n"
    )
    scenario = load(tables + gauges)
    assert scenario.gauge["f"].bodies == ["post.1", "post.2"]
    assert [scenario.gauge[f"p.{k}"].position[0] for k in (1, 2, 3)] == [0, 0.1, 0.2]


def particles(scenario, name):
    found, names = build_bodies(scenario)
    mine = found.body == names.index(name)
    return found.position[mine], found.velocity[mine], found.motion[mine]


def in_order(x):
    return x[np.lexsort(x.round(9).T)]


@pytest.mark.parametrize("shape", SHAPES)
def test_turned_copies_are_the_part_turned(load, shape):
    part = f'[body.b]\nmaterial = "basalt"\n{SHAPES[shape]}'
    angle, about = np.radians(40), np.array([1.0, -0.5])
    scenario = load(part + "array = { turns = 2, about = [1, -0.5], angle = 40 }\n")
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    (x, v, _), (y, w, _) = (particles(scenario, f"b.{k}") for k in (1, 2))
    np.testing.assert_allclose(in_order(about + (x - about) @ turn.T), in_order(y), atol=1e-12)
    np.testing.assert_allclose(in_order(v @ turn.T), in_order(w), atol=1e-12)
    first, second = scenario.body["b.1"], scenario.body["b.2"]
    if first.normal is not None:  # `rotate` turns it with the shape
        assert second.rotate == 40
        np.testing.assert_array_equal(first.normal, second.normal)
    if first.motion is not None:
        np.testing.assert_allclose(turn @ first.motion.velocity, second.motion.velocity)
        pivot = about + turn @ (first.motion.pivot - about)
        np.testing.assert_allclose(pivot, second.motion.pivot)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("axis", [0, 1])
def test_mirrored_copies_are_the_part_mirrored(load, shape, axis):
    part = f'[body.b]\nmaterial = "basalt"\n{SHAPES[shape]}'
    scenario = load(part + f'array = {{ mirror = "{"xy"[axis]}", at = -0.7 }}\n')
    flip = np.array([-1.0, 1.0] if axis == 0 else [1.0, -1.0])
    (x, v, _), (y, w, _) = (particles(scenario, f"b.{k}") for k in (1, 2))
    image = x * flip + np.where(flip < 0, -1.4, 0.0)
    np.testing.assert_allclose(in_order(image), in_order(y), atol=1e-12)
    np.testing.assert_allclose(in_order(v * flip), in_order(w), atol=1e-12)
    first, second = scenario.body["b.1"], scenario.body["b.2"]
    if first.motion is not None:
        assert second.motion.angular_velocity == -first.motion.angular_velocity


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_copies_of_three_dimensions(load, axis):
    box = 'shape = "box"\nmin = [0.1, 0, 0.2]\nmax = [0.3, 0.1, 0.26]\nrotate = 25\n'
    part = f'[body.b]\nmaterial = "basalt"\n{box}'
    ways = [
        (f'mirror = "{"xyz"[axis]}", at = 0', np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))),
        ("turns = 2, about = [0, 0, 0], angle = 90", np.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]])),
    ]
    for array, matrix in ways:
        scenario = load(f"{part}array = {{ {array} }}\n", dim=3)
        (x, *_), (y, *_) = (particles(scenario, f"b.{k}") for k in (1, 2))
        np.testing.assert_allclose(in_order(x @ matrix.T), in_order(y), atol=1e-12)


def test_a_section_with_a_width_has_no_mirrored_copy(load):
    """Its width goes towards the positive axes, and so would that of the image."""
    section = 'kind = "{kind}"\nposition = [0, 0.1, 0]\ndirection = [1, 0, 0]\n'
    array = "array = { mirror = 'y', at = 0 }\n"
    for kind in ("approach", "discharge"):
        part = f"{BALL}[gauge.g]\n{section.format(kind=kind)}"
        with pytest.raises(UserError, match="a section with a width of a 3-D run has no mirrored"):
            load(f"{part}width = 0.3\n{array}", dim=3)
    copies = load(f"{BALL}[gauge.g]\n{section.format(kind='approach')}{array}", dim=3).gauge
    assert copies["g.2"].position.tolist() == [0, -0.1, 0]


@pytest.mark.parametrize(
    ("array", "parts"),
    [
        ("{}", ["line 15: body.post.array: give one of count, file, turns, mirror"]),
        ("{ count = [2, 2], turns = 3 }", ["give one of"]),
        ("{ count = [2, 2] }", ["count goes with step, which is missing"]),
        ("{ count = [2], step = [1, 1] }", ["body.post.array.count: give 2 whole numbers"]),
        ("{ count = [0, 2], step = [1, 1] }", ["give 2 whole numbers from 1 on"]),
        ("{ count = [1000, 1000], step = [1, 1] }", ["1000000 copies; at most 10000"]),
        ("{ cout = [2, 2] }", ["body.post.array.cout is not a known key; did you mean count?"]),
        ("{ count = [2, 2], step = ['3 kg', 0] }", ['array.step.0 = "3 kg" is not a length']),
        ("{ turns = 3 }", ["turns goes with about"]),
        ("{ mirror = 'x', at = 0, angle = 3 }", ["angle goes with turns"]),
        ("{ mirror = 'z', at = 0 }", ['a 2-D run has no axis "z"']),
        ("{ file = 'none.csv' }", ["none.csv: no such file"]),
        ("{ file = '/dev/zero' }", ["body.post.array: ", "/dev/zero"]),
        ("{ file = 'huge.csv' }", ["huge.csv: placements may have at most 20 MB"]),
        ("{ file = 'bad.csv' }", ["bad.csv: row 2: y = 'two' is not a number"]),
        ("{ file = 'nan.csv' }", ["nan.csv: there must be rows, of finite numbers"]),
        ("{ file = 'empty.csv' }", ["empty.csv: there must be rows"]),
        ("{ file = 'more.csv' }", ['more.csv: "z" is no column; allowed: x [mm],y [mm],angle']),
        ("{ file = 'unit.csv' }", ['unit of "x [kg]" is not known; allowed: m, cm']),
        ("{ file = 'many.csv' }", ["10001 copies; at most 10000"]),
        ("7", ["body.post.array = 7 must be a table"]),
    ],
)
def test_what_is_no_array_is_refused(tmp_path, error_of, array, parts):
    files = {
        "bad": "x,y\n1,2\n1,two\n",
        "nan": "x,y\n1,nan\n",
        "empty": "x,y\n",
        "unit": "x [kg],y\n1,1\n",
        "more": "x,y,z\n1,2,3\n",
        "many": "x,y\n" + "1,2\n" * 10_001,
    }
    for name, text in files.items():
        (tmp_path / f"{name}.csv").write_text(text)
    with (tmp_path / "huge.csv").open("wb") as file:
        file.truncate(10**10)
    path = tmp_path / "case.toml"
    path.write_text(HEAD.format(dim=2) + DISC + f"array = {array}\n")
    message = error_of(str(path))
    for part in parts:
        assert part in message


@pytest.mark.parametrize(
    ("more", "array", "part"),
    [
        ('where = "= x - 1"', "{ count = [2, 1], step = [1, 1] }", "whose where depends on x, y"),
        (
            "",
            '{ count = [2, 1], step = [1, 1] }\n[body."post.2"]\nshape = "box"',
            "a copy so named",
        ),
    ],
)
def test_what_has_no_copies_is_refused(tmp_path, error_of, more, array, part):
    path = tmp_path / "case.toml"
    path.write_text(HEAD.format(dim=2) + DISC + f"{more}\narray = {array}\n")
    assert part in error_of(str(path))


def test_an_error_in_a_copy_is_shown_where_the_part_stands(tmp_path, error_of):
    path = tmp_path / "case.toml"
    path.write_text(
        HEAD.format(dim=2) + DISC + "radus = 3\narray = { count = [2, 1], step = [1, 1] }\n"
    )
    message = error_of(str(path))
    assert "line 15: body.post.1.radus is not a known key; did you mean radius?" in message


@pytest.mark.parametrize("name", ["[[]]", "[{ a = 1 }]", "[1, [2]]", "{ a = [] }"])
@pytest.mark.parametrize("key", ["bodies", "material"])
def test_what_is_no_name_is_refused_where_names_are_looked_up(tmp_path, error_of, key, name):
    path = tmp_path / "case.toml"
    kind = {"bodies": "force", "material": "mass_centre"}[key]
    path.write_text(HEAD.format(dim=2) + DISC + f'[gauge.g]\nkind = "{kind}"\n{key} = {name}\n')
    assert f"line 17: gauge.g.{key}" in error_of(str(path))


TANK = """
[body.tank]
shape = "tank"
material = "aluminium"
"""


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("opens", [None, [], ["-x", "+x"]])
def test_a_tank_has_walls_outside_its_inner_box(load, dim, opens):
    low, high = np.zeros(dim), np.array([0.4, 0.2, 0.3])[:dim]
    tank = TANK + f"min = {low.tolist()}\nmax = {high.tolist()}\nthickness = 0.06\n"
    scenario = load(tank + ("" if opens is None else f"open = {opens}\n"), dim=dim)
    found, names = build_bodies(scenario)
    sides = {f"{sign}{axis}" for axis in "xyz"[:dim] for sign in "-+"}
    sides -= {f"+{'xyz'[dim - 1]}"} if opens is None else set(opens)
    assert set(names) == {f"tank.{side}" for side in sides}
    assert (found.motion == FIXED).all()
    # Its particles are the cells of the outer box that are not inside, each once.
    outer = [
        (low - [0.06 * (f"-{a}" in sides) for a in "xyz"[:dim]]),
        (high + [0.06 * (f"+{a}" in sides) for a in "xyz"[:dim]]),
    ]
    cells = round(float(np.prod((outer[1] - outer[0]) / 0.02) - np.prod((high - low) / 0.02)))
    assert len(found) == cells
    assert len(np.unique((found.position / 0.02).round(3), axis=0)) == cells
    assert not ((found.position > low) & (found.position < high)).all(axis=1).any()
    for name in names:
        axis, sign = "xyz".index(name[-1]), -1 if name[-2] == "-" else 1
        assert scenario.body[name].normal[axis] == -sign


def test_the_walls_of_a_tank_are_as_thick_as_the_kernel_sees(load):
    scenario = load(TANK + "min = [0, 0]\nmax = [0.4, 0.2]\nwall = 'free_slip'\n")
    assert scenario.body["tank.-y"].layers(0.02) == 3
    assert scenario.body["tank.-x"].wall == "free_slip"


@pytest.mark.parametrize(
    ("keys", "part"),
    [
        ("min = [0, 0]\nmax = [0, 1]\n", "every entry of min must be below that of max"),
        ("min = [0, 0]\nmax = [1, 1]\nopen = ['-z']\n", 'body.tank: a 2-D tank has no side "-z"'),
        ("min = [0, 0]\nmax = [1, 1]\nopen = ['up']\n", "open.0 = 'up' is not allowed; choose"),
        ("min = [0, 0]\nmax = [1, 1]\nfixed = false\n", "a tank is fixed"),
        ("min = [0, 0]\n", "body.tank.max is missing"),
        ("min = [0, 0]\nmax = [1, 1]\nradius = 2\n", "body.tank.radius is not a known key"),
    ],
)
def test_what_is_no_tank_is_refused(tmp_path, error_of, keys, part):
    path = tmp_path / "case.toml"
    path.write_text(HEAD.format(dim=2) + TANK + keys)
    assert part in error_of(str(path))


@pytest.mark.parametrize(
    ("key", "value", "part"),
    [
        ("dp", "[0.02]", "dp = [0.02] must be a number"),
        ("dp", "2020-01-01", "dp = 2020-01-01 must be a number"),
        ("dp", "{ a = 1 }", "dp = { a = 1 } must be a number"),
        ("dp", "1" + "0" * 400, "dp = 1000000000... (401 digits) is out of range"),
        ("eta", "[1]", "eta = [1] must be a number"),
        ("kernel", "'cubic'", "kernel = 'cubic' is not allowed; choose"),
    ],
)
def test_a_wrong_key_is_to_blame_and_not_the_tank_that_needs_it(
    tmp_path, error_of, key, value, part
):
    path = tmp_path / "case.toml"
    head = [line for line in HEAD.format(dim=2).splitlines() if not line.startswith(f"{key} =")]
    tank = TANK + "min = [0, 0]\nmax = [0.4, 0.2]\n"
    path.write_text("\n".join([f"{key} = {value}", *head, tank]))
    assert f"case.toml, line 1: {part}" in error_of(str(path))


@pytest.mark.parametrize("value", ["[1, 2]", "{ a = 1 }", "true"])
@pytest.mark.parametrize("key", ["dp", "speed_max", "eta", "skin", "time_history", "slope"])
def test_a_key_that_is_no_number_is_to_blame_and_not_the_parameter_that_uses_it(
    tmp_path, error_of, key, value
):
    path = tmp_path / "case.toml"
    head = [line for line in HEAD.format(dim=2).splitlines() if not line.startswith(f"{key} =")]
    uses = f'[parameters]\nquarter = "= {key}/4"\n'
    path.write_text("\n".join([f"{key} = {value}", *head, uses]))
    assert error_of(str(path)).startswith(f"{path}, line 1: {key} = {value}")


def test_boxes_that_dp_does_not_divide_are_reported_with_the_size_they_got(load):
    box = '[body.{}]\nshape = "box"\nmaterial = "water"\nmin = [{}, 0]\nmax = [{}, 0.2]\n'
    lines = check_scenario(load(box.format("whole", 0, 0.4) + box.format("odd", 1, 1.405)))
    assert "0.4 x 0.2 m: dp = 0.02 m does not divide 0.405 x 0.2 m" in lines
    assert lines.count("does not divide") == 1
