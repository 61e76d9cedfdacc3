"""PLY files of faces with any number of corners, in text and binary."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from doseki.scene.meshes.making import made_mesh
from doseki.scene.meshes.reading import read_triangles
from doseki.scene.shapes import ShapeError

CUBE = np.array([[x, y, z] for x in (0, 0.4) for y in (-0.1, 0.2) for z in (-0.4, 0.8)])
FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
PYRAMID = [[0, 1, 2, 3, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [4, 3, 5], [0, 4, 5]]


def ply_of(order: str, corners: np.ndarray, faces: list[list[int]]) -> bytes:
    """A PLY of faces of any number of corners, with properties and elements that nobody reads."""
    form = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    lines = (
        f"ply\nformat {form} 1.0\nelement vertex {len(corners)}\nproperty double x\n"
        "property double y\nproperty double z\nproperty uchar red\n"
        f"element face {len(faces)}\nproperty float quality\n"
        "property list uchar int vertex_indices\nelement edge 1\nproperty int from\nend_header\n"
    )
    rows = [[*row, 7] for row in corners.tolist()]
    lists = [[0.5, len(face), *face] for face in faces]
    if not order:
        return (
            lines + "".join(" ".join(map(str, row)) + "\n" for row in [*rows, *lists, [3]])
        ).encode()
    packed = [struct.pack(f"{order}3dB", *row) for row in rows]
    packed += [struct.pack(f"{order}fB{row[1]}i", *row) for row in lists]
    return lines.encode() + b"".join(packed) + struct.pack(f"{order}i", 3)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("faces", [FACES, FACES[::-1], PYRAMID])
def test_a_binary_ply_of_faces_of_any_corners_is_the_mesh_of_its_text(tmp_path, order, faces):
    angle = 0.4 * np.pi * np.arange(5)
    base = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    corners = np.vstack([base[::-1], [0, 0, 1]]) if faces is PYRAMID else CUBE
    for name, form in (("text.ply", ""), ("binary.ply", order)):
        (tmp_path / name).write_bytes(ply_of(form, corners, faces))
    text, binary = (read_triangles(tmp_path / name, 1.0) for name in ("text.ply", "binary.ply"))
    np.testing.assert_array_equal(binary.vertices, text.vertices)
    np.testing.assert_array_equal(binary.faces, text.faces)
    assert not made_mesh(tmp_path / "binary.ply", 1.0, 0.0).findings("wall")
    whole = ply_of(order, corners, faces)
    for damaged in (whole[:-5], whole + b"\0", whole[:-40]):
        (tmp_path / "binary.ply").write_bytes(damaged)
        with pytest.raises(ShapeError, match="cannot be read as PLY: it is cut short, damaged"):
            read_triangles(tmp_path / "binary.ply", 1.0)


@pytest.mark.parametrize("order", ["", "<", ">"])
@pytest.mark.parametrize(
    ("face", "said"), [([], "0 vertices"), ([2], "1 vertex"), ([2, 3], "2 vertices")]
)
@pytest.mark.parametrize("alike", [False, True])
def test_a_face_of_too_few_corners_is_refused_as_in_an_obj(tmp_path, order, face, said, alike):
    """Also in a file that has no others."""
    faces = [face] * 3 if alike else [*FACES[:2], face, *FACES[2:]]
    (tmp_path / "a.ply").write_bytes(ply_of(order, CUBE, faces))
    number = 1 if alike else 3
    with pytest.raises(ShapeError, match=f"a.ply: face {number} has {said}; three or more"):
        read_triangles(tmp_path / "a.ply", 1.0)
