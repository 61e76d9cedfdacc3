"""Triangles from STL, OBJ and PLY files, whoever made them."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UserError
from ...scenario.values.types import LARGEST
from ...util.foreign import read_bytes, readable
from ..shapes import ShapeError, Triangles
from ..shapes.making import quiet
from ..shapes.mesh_lines import check_obj, check_ply_header
from ..shapes.stl import in_utf8, readable_stl
from .ply import FEWEST, mixed_faces, text_corners

LARGEST_FILE = 200_000_000  # bytes
HEADER_PLY = 2**20  # bytes: scanners write long comments
LOST = "a face names a vertex that is not there"


def read_triangles(file: Path, scale: float) -> Triangles:
    """The triangles of a file, in m: vertices of one place joined, those without area left out.

    Raises ShapeError where the file cannot be read or holds nothing of use.
    """
    try:
        content = read_bytes(file, LARGEST_FILE)
        kind = file.suffix.lower()[1:]
        with readable(file, kind=kind.upper()), quiet():
            _check_counts(file, kind, content)
            vertices, faces = _parsed(file, kind, content)
        return _joined(file, vertices, faces, scale)
    except ShapeError:
        raise
    except UserError as error:
        raise ShapeError(str(error)) from None


def _check_counts(file: Path, kind: str, content: bytes) -> None:
    """Refuse what says that it has more than fits, before room is made for it, and a text that has
    been cut short, of which a reader takes what is there.
    """
    if kind != "ply":
        return
    header, end, _ = content[:HEADER_PLY].partition(b"end_header")
    header = header if end else header[: header.rfind(b"\n") + 1]  # the last line is cut here
    check_ply_header(file, header, len(content))
    counts = re.findall(rb"element\s+(\S+)\s+(\d+)", header)
    if re.search(rb"^format\s+ascii\b", header, re.MULTILINE):
        said = sum(int(count) for _, count in counts)
        rows = content.partition(b"end_header")[2].splitlines()
        if (found := sum(1 for row in rows if row.strip())) != said:
            raise UserError(
                f"{file}: has {found} lines after its header, which says {said}; it is cut short, "
                "or damaged"
            )


def _readable(file: Path, kind: str, content: bytes) -> bytes:
    """The content with names and comments, which come in any encoding, in UTF-8."""
    if kind == "stl":
        return readable_stl(file, content)
    if kind == "obj":
        check_obj(file, content)
    text, end, rest = content.partition(b"end_header") if kind == "ply" else (content, b"", b"")
    return in_utf8(text) + end + rest


def _parsed(file: Path, kind: str, content: bytes) -> tuple[np.ndarray, np.ndarray]:
    import trimesh

    options: dict[str, Any] = {"process": False, "skip_materials": True}
    if kind == "stl":
        options.pop("skip_materials")
    mixed = mixed_faces(content) if kind == "ply" else None
    if kind == "ply":
        _check_corners(file, text_corners(content) if mixed is None else map(len, mixed[1]))
    if mixed is not None:
        vertices, corners = mixed
        faces = trimesh.geometry.triangulate_quads(corners)
    else:
        image = io.BytesIO(_readable(file, kind, content))
        try:
            mesh = trimesh.load_mesh(image, file_type=kind, **options)
        except IndexError:
            raise UserError(f"{file}: {LOST}") from None
        faces = np.asarray(getattr(mesh, "faces", np.zeros((0, 3))), np.int64)
        vertices = np.asarray(mesh.vertices, float)
    if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,):
        raise UserError(f"{file}: its vertices are no points of space, or its faces no triangles")
    if not len(faces):
        raise UserError(f"{file}: no triangle")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise UserError(f"{file}: {LOST}")
    return vertices, faces


def _check_corners(file: Path, counts: Iterable[int]) -> None:
    """Refuse a face of fewer than three vertices, as in OBJ files."""
    for number, count in enumerate(counts, start=1):
        if count < FEWEST:
            of = "1 vertex" if count == 1 else f"{count} vertices"
            raise UserError(f"{file}: face {number} has {of}; three or more are needed")


def _joined(file: Path, vertices: np.ndarray, faces: np.ndarray, scale: float) -> Triangles:
    used = vertices[faces]
    if not np.isfinite(used).all():
        raise ShapeError(f"{file}: a vertex is not finite")
    with np.errstate(over="ignore"):
        used = used * scale
    if not np.abs(used).max() <= LARGEST:
        raise ShapeError(f"{file}: a vertex is beyond {LARGEST:g} m")
    places, index = np.unique(used.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    found = Triangles(places, index.reshape(-1, 3).astype(np.int64))
    size = float(np.ptp(places, axis=0).max())
    kept = np.linalg.norm(found.areas, axis=1) > 1e-14 * size**2
    if not kept.any():
        raise ShapeError(f"{file}: its triangles have no area")
    faces = found.faces[kept]
    _check_repeated(file, np.flatnonzero(kept), faces)
    return Triangles(places, faces)


def _check_repeated(file: Path, number: np.ndarray, faces: np.ndarray) -> None:
    """Refuse a triangle that is there twice, turned the same way; `number` (n,) is where each of
    `faces` stands in the file, from 0 on.
    """
    first = np.argmin(faces, axis=1)[:, None]
    turned = np.take_along_axis(faces, (first + np.arange(3)) % 3, axis=1)
    _, of, index = np.unique(turned, axis=0, return_index=True, return_inverse=True)
    again = np.flatnonzero(of[index.ravel()] != np.arange(len(faces)))
    if len(again):
        one, other = number[of[index.ravel()[again[0]]]] + 1, number[again[0]] + 1
        more = len(again) - 1
        others = f", and {more} more {'is' if more == 1 else 'are'} twice" if more else ""
        raise ShapeError(
            f"{file}: triangle {other} is triangle {one} again{others}; leave each out once"
        )
