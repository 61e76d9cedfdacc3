"""Meshes as walls: their files, whoever made them, and particles below their surfaces."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from doseki.errors import UserError
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.scene.meshes.making import made_mesh, wall_particles
from doseki.scene.shapes import ShapeError
from doseki.solver.build import build_simulation

DP, DEPTH = 0.02, 0.06
HEAD = """\
dim = 3
scheme = "{scheme}"
dp = 0.02
time_max = 0.02
time_out = 0.02
gravity = [0, 0, -9.81]
{more}

[body.wall]
shape = "mesh"
material = "basalt"
file = "{file}"
{keys}
"""
WATER = """
[body.water]
shape = "box"
material = "water"
min = [-0.2, -0.2, -0.2]
max = [0.2, 0.2, 0.2]
"""


def box() -> trimesh.Trimesh:
    return trimesh.creation.box(extents=(0.4, 0.3, 0.2))


def ball() -> trimesh.Trimesh:
    return trimesh.creation.icosphere(subdivisions=4, radius=0.3)


def trapezium() -> trimesh.Trimesh:
    """A dam with slanted sides."""
    ends = [(x, y, z) for x, z in ((0, 0), (1, 0), (0.63, 0.5), (0.3, 0.5)) for y in (0, 0.6)]
    return trimesh.convex.convex_hull(np.array(ends))


def written(folder: Path, mesh: trimesh.Trimesh, name: str = "wall.ply") -> Path:
    mesh.export(folder / name, **({"vertex_normal": False} if name.endswith("ply") else {}))
    return folder / name


def scenario(folder: Path, file: str = "wall.ply", *, body: str = "", **values: str) -> Path:
    """The path of one with this mesh; `body`: others."""
    text = HEAD.format(**{"scheme": "resolved", "more": "speed_max = 2", "keys": ""} | values,
                       file=file)  # fmt: skip
    (folder / "mesh.toml").write_text(text + body)
    return folder / "mesh.toml"


def wendland(r: np.ndarray, support: float) -> np.ndarray:
    q = r / support
    shape = np.where(q < 1, (1 - q) ** 8 * (1 + 8 * q + 25 * q**2 + 32 * q**3), 0)
    return shape * 1365 / (64 * np.pi * support**3)


def places(mesh: trimesh.Trimesh, away: float) -> tuple[np.ndarray, np.ndarray]:
    """Points of the surface, no nearer than `away` to its sharp edges, and their normals."""
    points, face = trimesh.sample.sample_surface(mesh, 1500, seed=1)
    sharp = mesh.face_adjacency_edges[mesh.face_adjacency_angles > 0.3]
    keep = np.ones(len(points), bool)
    for a, b in mesh.vertices[sharp]:
        t = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        keep &= np.linalg.norm(points - a - t[:, None] * (b - a), axis=1) > away
    return points[keep], mesh.face_normals[face[keep]]


@pytest.mark.parametrize("make", [box, ball, trapezium])
def test_a_wall_has_no_holes_and_an_even_face(tmp_path, make):
    """What the kernel of a particle half a spacing above the surface sees of the wall."""
    mesh = make()
    made = made_mesh(written(tmp_path, mesh), 1.0, 0.0)
    x = made.middle + wall_particles(made.shape, DP, DEPTH)
    point, normal = places(mesh, 2.5 * DP)
    probe = point + 0.5 * DP * normal
    near = cKDTree(x).query_ball_point(probe, DEPTH)
    seen = np.array([
        DP**3 * wendland(np.linalg.norm(x[k] - p, axis=1), DEPTH).sum()
        for k, p in zip(near, probe, strict=True)
    ])  # fmt: skip
    plane = 0.1797  # below a plane
    assert seen.mean() == pytest.approx(plane, rel=0.08)
    assert seen.std() < 0.08 * plane
    assert seen.min() > 0.7 * plane, "a hole"
    assert cKDTree(x).query(x, 2)[0][:, 1].min() > 0.6 * DP
    _, depth = made.shape.wall(x - made.middle, DP)
    assert depth.min() > 0.3 * DP
    assert depth.max() < DEPTH + 0.5 * DP


def test_particles_of_a_box_are_those_of_its_lattice(tmp_path):
    made = made_mesh(written(tmp_path, box()), 1.0, 0.0)
    x = wall_particles(made.shape, DP, DEPTH)
    axes = [(np.arange(round(side / DP)) + 0.5) * DP - side / 2 for side in (0.4, 0.3, 0.2)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    shell = (np.array([0.2, 0.15, 0.1]) - np.abs(lattice)).min(axis=1) < DEPTH
    assert len(x) == shell.sum()
    assert cKDTree(lattice[shell]).query(x)[0].max() < 1e-6 * DP


def test_a_mesh_that_is_turned_in_its_file_has_the_same_particles(tmp_path):
    turn = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])
    one = made_mesh(written(tmp_path, trapezium()), 1.0, 0.0)
    two = made_mesh(written(tmp_path, trapezium().apply_transform(turn), "b.ply"), 1.0, 0.0)
    x = one.middle + wall_particles(one.shape, DP, DEPTH)
    y = two.middle + wall_particles(two.shape, DP, DEPTH)
    assert len(x) == pytest.approx(len(y), rel=2e-3), "files hold single precision"
    moved = x @ turn[:3, :3].T
    assert np.median(cKDTree(y).query(moved)[0]) < 1e-3 * DP


def test_normals_beside_an_edge_are_means(tmp_path):
    made = made_mesh(written(tmp_path, box()), 1.0, 0.0)
    below = np.array([[0.19, 0, 0.0], [0.19, 0.14, 0.0], [0.19, 0.14, 0.09], [0.19, 0.139, 0]])
    normal, depth = made.shape.wall(below, DP)
    r = np.sqrt([1, 1 / 2, 1 / 3])
    exact = [[1, 0, 0], [r[1], r[1], 0], [r[2]] * 3]
    assert normal[:3] == pytest.approx(np.array(exact), abs=1e-5)
    assert normal[3] == pytest.approx(np.array([2, 1, 0]) / np.sqrt(5), abs=1e-5)
    assert depth == pytest.approx(0.01, rel=1e-5)


@pytest.mark.parametrize("kind", ["stl", "obj", "ply"])
def test_files_of_all_kinds_are_one_body(tmp_path, kind):
    made = made_mesh(written(tmp_path, trapezium(), f"a.{kind}"), 2.0, 0.0)
    assert made.shape.measure == pytest.approx(8 * trapezium().volume, rel=1e-5)
    assert not made.findings("wall")


@pytest.mark.parametrize("turned", [[0], [1, 4, 7], list(range(12))])
def test_triangles_that_face_inwards_are_turned(tmp_path, turned):
    mesh = box()
    faces = np.array(mesh.faces)
    faces[turned] = faces[turned][:, ::-1]
    broken = trimesh.Trimesh(mesh.vertices, faces, process=False)
    made = made_mesh(written(tmp_path, broken), 1.0, 0.0)
    assert made.shape.contains(np.array([[0, 0, 0], [0, 0, 0.11]])).tolist() == [True, False]
    _, depth = made.shape.wall(np.array([[0, 0, 0.09]]), DP)
    assert depth == pytest.approx(0.01)
    (finding,) = made.findings("wall")
    assert f"wall: {len(turned)} of 12 triangles of its file faced inwards" in str(finding)


def test_a_hollow_body_stays_hollow(tmp_path):
    inner = trimesh.creation.box(extents=(0.2, 0.1, 0.1))
    inner.invert()
    made = made_mesh(written(tmp_path, trimesh.util.concatenate([box(), inner])), 1.0, 0.0)
    assert made.shape.contains(np.array([[0, 0, 0], [0.15, 0, 0]])).tolist() == [False, True]
    assert not made.findings("wall")


def test_a_mesh_that_cuts_itself_is_told(tmp_path):
    other = trimesh.creation.box(extents=(0.1, 0.1, 0.6))
    made = made_mesh(written(tmp_path, trimesh.util.concatenate([box(), other])), 1.0, 0.0)
    (finding,) = made.findings("wall")
    assert "its surface cuts itself" in str(finding)
    inside = made.shape.contains(np.array([[0, 0, 0], [0, 0, 0.29], [0.1, 0, 0.2]]))
    assert inside.tolist() == [True, True, False]


def stl_of(triangles: np.ndarray, count: int | None = None) -> bytes:
    """A binary STL, which may lie about how many there are."""
    rows = np.zeros(len(triangles), [("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    rows["v"] = triangles
    declared = len(triangles) if count is None else count
    return b"\0" * 80 + struct.pack("<I", declared) + rows.tobytes()


CORNERS = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"
HOSTILE = {
    "header.stl": (stl_of(np.zeros((0, 3, 3)), 10**8), "100000000 triangles are said to follow"),
    "more.stl": (stl_of(box().triangles, 3), "3 triangles are said to follow, it holds 12;"),
    "less.stl": (stl_of(box().triangles)[:-25], "12 triangles are said to follow, it holds 11.5;"),
    "empty.stl": (b"", "no triangle"),
    "none.stl": (stl_of(np.zeros((0, 3, 3))), "no triangle|cannot be read"),
    "nan.stl": (stl_of(np.where(np.arange(9) == 4, np.nan, box().triangles.reshape(-1, 9))
                       .reshape(-1, 3, 3)), "not finite"),
    "open.stl": (stl_of(box().triangles[1:]), "not closed: 3 edges .* set sheet = true"),
    "flat.stl": (stl_of(np.zeros((8, 3, 3))), "no area"),
    "far.stl": (stl_of(1e30 * box().triangles), "beyond"),
    "end.stl": (box().export(file_type="stl_ascii").encode().rpartition(b"endsolid")[0],
                "is cut off: no line `endsolid`"),
    "half.stl": (box().export(file_type="stl_ascii").encode()[:900], "is cut off"),
    "many.ply": (b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999999\n"
                 b"property float x\nend_header\n",
                 "line 3: 99999999999999 of the element vertex are more than a file of 94 bytes"),
    "blob.ply": (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty blob x\nend_header\n1\n",
                 "line 4: 'blob' is no type of a number; known: char, uchar"),
    "words.ply": (b"ply\nformat ascii 1.0\nelement vertex many\nend_header\n",
                  "line 3: element vertex has 'many', which is not a whole number"),
    "half.ply": (box().export(file_type="ply", vertex_normal=False)[:-20],
                 "cannot be read as PLY: it is cut short, damaged, or not PLY"),
    "cut.ply": (box().export(file_type="ply", encoding="ascii", vertex_normal=False)[:-20],
                "has 18 lines after its header, which says 20; it is cut short, or damaged"),
    "again.stl": (stl_of(box().triangles[[*range(12), 4]]), "triangle 13 is triangle 5 again;"),
    "turned.stl": (stl_of(np.roll(box().triangles[[*range(12), 4, 7]], 1, axis=1)),
                   "triangle 13 is triangle 5 again, and 1 more"),
    "index.obj": (CORNERS + b"f 1 2 9\n", "obj: a face names a vertex that is not there"),
    "words.obj": (CORNERS + b"f 1 2 3\nf a b c\n", "line 5: a face has 'a', which is not a number"),
    "two.obj": (CORNERS + b"f 1 2 3\nf 1 2 # 3\n", "line 5: a face of 2 vertices; three or more"),
    "comma.obj": (b"v 0 0 0\nv 1,5 0 0\n", "line 2: a vertex has '1,5', which is not a number;"),
    "comma.stl": (b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1,5\nendsolid\n",
                  "line 4: a vertex has '1,5', which is not a number; decimal numbers have points"),
    "short.stl": (b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 1\nendsolid\n",
                  "line 4: a vertex of 2 numbers; three are needed"),
    "zero.obj": (CORNERS + b"f 1 2 3\nf 1//1 0//1 3//1\n", "line 5: a face names vertex 0"),
    "text.obj": (b"hello", "no triangle|cannot be read"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_a_bad_file_is_refused_in_one_sentence(tmp_path, capfd, name):
    content, said = HOSTILE[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ShapeError, match=said) as caught:
        made_mesh(tmp_path / name, 1.0, 0.0)
    assert str(caught.value).count("\n") == 0
    assert capfd.readouterr() == ("", "")


def test_names_and_comments_come_in_any_encoding(tmp_path, monkeypatch):
    """Also without charset_normalizer, which trimesh would guess the encoding with."""
    monkeypatch.setitem(sys.modules, "charset_normalizer", None)
    for kind in ("obj", "ply", "stl_ascii"):
        text = box().export(file_type=kind, **({"encoding": "ascii"} if kind == "ply" else {}))
        text = text.encode() if isinstance(text, str) else text
        name = "H\xfcgel".encode("latin-1")
        text = text.replace(b"solid", b"solid " + name).replace(
            b"1.0\n", b"1.0\ncomment %s\n" % name
        )
        file = tmp_path / f"wall.{kind[:3]}"
        file.write_bytes(b"# " + name + b"\n" + text if kind == "obj" else text)
        assert len(made_mesh(file, 1.0, 0.0).shape.mesh.faces) == 12


def test_normals_of_an_stl_that_are_no_numbers_do_no_harm(tmp_path):
    text = box().export(file_type="stl_ascii").replace("normal 0.0", "normal -nan(ind)")
    assert "nan" in text
    (tmp_path / "wall.stl").write_text(text)
    made = made_mesh(tmp_path / "wall.stl", 1.0, 0.0)
    assert made.shape.contains(np.array([[0, 0, 0]])).all()


def test_triangles_without_area_are_left_out(tmp_path):
    corners = box().triangles
    needle = np.array([[corners[0][0], corners[0][0], corners[0][1]]])
    (tmp_path / "a.stl").write_bytes(stl_of(np.concatenate([corners, needle])))
    assert len(made_mesh(tmp_path / "a.stl", 1.0, 0.0).shape.mesh.faces) == 12


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("fixed = false", 'a mesh is fixed; a convex body that moves is shape = "stl"'),
        ("normal = [0, 0, 1]", "its normals are those of its triangles"),
        ("thickness = 0.1", "set sheet = true"),
        ("spin = [1, 0, 0]", "spin"),
        ('ks = 0.01', "ks goes with wall"),
    ],
)  # fmt: skip
def test_keys_that_mean_nothing_are_refused(tmp_path, keys, said):
    written(tmp_path, box())
    with pytest.raises(UserError, match=said):
        load_scenario(str(scenario(tmp_path, keys=keys)))


def test_a_file_of_another_kind_is_refused(tmp_path):
    with pytest.raises(UserError, match=r"must end in one of .stl, .obj, .ply"):
        load_scenario(str(scenario(tmp_path, "wall.step")))


def test_a_file_that_is_missing_is_told_with_its_key(tmp_path):
    with pytest.raises(UserError, match=r"toml, line \d+: body.wall: .*no.stl: no such file"):
        build_scene(load_scenario(str(scenario(tmp_path, "no.stl"))))


def test_water_makes_room_for_all_that_the_mesh_encloses(tmp_path):
    written(tmp_path, trimesh.creation.box(extents=(0.4, 0.28, 0.2)))
    path = scenario(tmp_path, body=WATER, keys="position = [0.06, 0, 0]\nrotate = 90")
    scene = build_scene(load_scenario(str(path)))
    water = scene.particles.position[scene.particles.motion == 0]
    inside = (np.abs(water - [0.06, 0, 0]) < [0.1, 0.14, 0.2]).all(axis=1)
    assert not inside.any()
    assert len(water) == 20**3 - 10 * 14 * 20


def test_a_thin_wall_is_told(tmp_path):
    written(tmp_path, trimesh.creation.box(extents=(0.4, 0.3, 0.04)))
    scene = build_scene(load_scenario(str(scenario(tmp_path))))
    (warning,) = [str(w) for w in scene.warnings]
    assert "walls down to 0.04 m thick; the kernel sees 0.06 m" in warning


def test_the_printed_scheme_has_meshes_too(tmp_path):
    written(tmp_path, box())
    path = scenario(tmp_path, scheme="ueta2022", more="xi = 0.01", body=WATER)
    simulation, _ = build_simulation(load_scenario(str(path)))
    before = simulation.state()
    simulation.advance(limit=0.01, pause=0.01, max_steps=10**6)
    after = simulation.state()
    fixed = before["motion"] == 1
    assert fixed.sum() > 1000
    assert np.array_equal(before["position"][fixed], after["position"][fixed])
    assert np.isfinite(after["velocity"]).all()


def test_parts_of_a_file_are_one_body(tmp_path):
    """A gauge that asks for one of them is told what to do."""
    parts = [box().apply_translation((0.5 * k, 0, 0)) for k in range(2)]
    written(tmp_path, trimesh.util.concatenate(parts))
    gauge = '[gauge.load]\nkind = "load"\nbodies = ["wall{}"]\n'
    load_scenario(scenario(tmp_path, body=gauge.format("")))
    for name in (".1", ".2"):
        with pytest.raises(UserError, match=r"\[body\.wall\] is one body .* a file and a"):
            load_scenario(scenario(tmp_path, body=gauge.format(name)))
    with pytest.raises(UserError, match="did you mean wall"):
        load_scenario(scenario(tmp_path, body=gauge.format("s")))


def test_a_vertex_of_many_numbers_is_refused_at_once(tmp_path):
    """Lines that have lost their ends: a search for numbers could go through all their splits."""
    numbers = " ".join(["123456"] * 40)
    (tmp_path / "wall.obj").write_text(f"v 0 0 0\nv {numbers} x\n")
    with pytest.raises(UserError, match=r"line 2: a vertex has 'x', which is not a number"):
        build_scene(load_scenario(str(scenario(tmp_path, file="wall.obj"))))


def test_a_header_with_long_comments_is_read(tmp_path):
    box().export(tmp_path / "wall.ply", encoding="ascii")
    lines = (tmp_path / "wall.ply").read_text().splitlines(keepends=True)
    lines[2:2] = [f"comment {'scanned ' * 20}{k}\n" for k in range(40)]
    (tmp_path / "wall.ply").write_text("".join(lines))
    build_scene(load_scenario(str(scenario(tmp_path, file="wall.ply"))))


PACKED = 'shape = "sphere"\nmaterial = "basalt"\nd = 0.1\ncount = 2\n'
TURNED = {
    "mesh": "",
    "box": WATER.replace("water]", "turned]"),
    "packing": f"[body.turned]\n{PACKED}min = [1, 1, 1]\nmax = [2, 2, 2]\n",
}


@pytest.mark.parametrize("axis", ["[0, 0, 0]", "[0, 0, 1e-320]"])
@pytest.mark.parametrize("kind", TURNED)
def test_an_axis_without_a_length_is_refused(tmp_path, kind, axis):
    written(tmp_path, box())
    rotated = f"rotate = 30\nrotate_axis = {axis}\n"
    keys = rotated if kind == "mesh" else ""
    path = scenario(tmp_path, keys=keys, body=TURNED[kind] + ("" if keys else rotated))
    with pytest.raises(UserError, match=r"rotate_axis = .*: only a 3-D run has one, other than"):
        build_scene(load_scenario(path))
