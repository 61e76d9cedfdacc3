"""Whatever a file of triangles holds: a body or a wall, or one sentence."""

from __future__ import annotations

import contextlib
import io

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from doseki.scene.meshes.layers import layer_count
from doseki.scene.meshes.making import made_mesh
from doseki.scene.shapes import Convex, ShapeError, mesh_shape

from .examples import examples
from .generators import damaged


def stl(form: str, kind: str) -> bytes:
    """A body in a file, binary or text."""
    mesh = {
        "box": lambda: trimesh.creation.box(extents=(1, 2, 3)),
        "ball": lambda: trimesh.creation.icosphere(subdivisions=1),
        "ring": lambda: trimesh.creation.annulus(0.5, 1, 1, sections=8),
    }[kind]()
    image = io.BytesIO()
    mesh.export(image, file_type="stl" if form == "binary" else "stl_ascii")
    return image.getvalue()


WHOLE = [stl(form, kind) for form in ("binary", "text") for kind in ("box", "ball", "ring")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("stl")


def test_what_is_wrong_with_a_file_is_said_once(folder, capfd, caplog):
    """Damaged normals and a surface without volume, of which trimesh and numpy would tell too."""
    text = stl("text", "box")
    (folder / "normals.stl").write_bytes(text.replace(b"facet normal", b"facet normal x", 1))
    (folder / "flat.stl").write_bytes(text.replace(b"1.5", b"0").replace(b"-0", b"0"))
    for name in ("normals", "flat"):
        with contextlib.suppress(ShapeError):
            mesh_shape(folder / f"{name}.stl", 1.0)
    assert capfd.readouterr() == ("", "")
    assert not caplog.records


@examples(40, 10_000)
@given(data=st.sampled_from(WHOLE).flatmap(damaged), scale=st.sampled_from([1.0, 1e-300, 1e300]))
@pytest.mark.filterwarnings("error")
def test_any_stl(folder, data, scale):
    (folder / "a.stl").write_bytes(data)
    try:
        shape, centre = mesh_shape(folder / "a.stl", scale)
    except ShapeError:
        return
    assert isinstance(shape, Convex)
    assert np.isfinite(shape.vertices).all()
    assert np.isfinite(centre).all()
    assert shape.measure > 0


def image_of(kind: str) -> bytes:
    """A ring in a file of this kind."""
    image = io.BytesIO()
    trimesh.creation.annulus(0.5, 1, 1, sections=8).export(image, file_type=kind)
    return image.getvalue()


def mixed_ply() -> bytes:
    """A wedge of two triangles and three faces of four corners."""
    head = (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 6\nproperty float x\n"
        b"property float y\nproperty float z\nelement face 5\n"
        b"property list uchar int vertex_indices\nend_header\n"
    )
    places = np.array([[x, y, z] for x in (0, 1) for y, z in ((0, 0), (1, 0), (0, 1))], "<f4")
    faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
    lists = b"".join(bytes([len(face)]) + np.array(face, "<i4").tobytes() for face in faces)
    return head + places.tobytes() + lists


KINDS = {kind: image_of(kind) for kind in ("stl", "ply", "obj")} | {"mixed.ply": mixed_ply()}


@examples(60, 10_000)
@given(
    data=st.sampled_from(sorted(KINDS)).flatmap(
        lambda kind: st.tuples(st.just(kind), damaged(KINDS[kind]))
    ),
    scale=st.sampled_from([1.0, 1e-300, 1e300]),
    thickness=st.sampled_from([0.0, 0.1]),
)
@pytest.mark.filterwarnings("error")
def test_any_mesh(folder, data, scale, thickness):
    kind, content = data
    (folder / f"m.{kind}").write_bytes(content)
    try:
        made = made_mesh(folder / f"m.{kind}", scale, thickness)
    except ShapeError:
        return
    assert np.isfinite(made.shape.mesh.vertices).all()
    assert np.isfinite(made.middle).all()
    assert made.shape.area > 0
    assert layer_count(made.shape, 0.1, 0.3) > 0
    _, depth = made.shape.wall(np.zeros((1, 3)), 0.1)
    assert np.isfinite(depth).all()


@pytest.mark.parametrize("flipped", [[0], [1, 4, 7], list(range(12))])
def test_triangles_may_turn_either_way(folder, flipped):
    mesh = trimesh.creation.box(extents=(1, 2, 3))
    faces = np.array(mesh.faces)
    faces[flipped] = faces[flipped][:, ::-1]
    turned = trimesh.Trimesh(mesh.vertices, faces, process=False)
    turned.export(folder / "b.stl")
    shape, centre = mesh_shape(folder / "b.stl", 1.0)
    assert shape.measure == pytest.approx(6)
    assert centre == pytest.approx([0, 0, 0], abs=1e-12)
    _, distance = shape.planes
    assert len(distance) == 6
    assert (distance > 0).all()
