"""STL and PLY: triangles for programs of solids and pictures.

Most of their readers keep places in single precision, STL itself does: surfaces far from the origin
of their coordinates are written about a point nearby, which the file names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

FAR = 2.0**14  # sizes of a cell from the origin, where single precision leaves 1/1000 of a cell

Triangles = tuple[np.ndarray, np.ndarray]  # vertices (n, 3), m, and faces (m, 3)


def near_origin(points: np.ndarray, cell: float) -> np.ndarray:
    """What is to be taken off places (n, 3), whole metres (3,); zero where they are near enough."""
    if not len(points) or np.abs(points).max() <= FAR * cell:
        return np.zeros(3)
    return np.asarray(np.floor(points.min(axis=0)))


def write_stl(path: Path, mesh: Triangles, origin: np.ndarray, about: str) -> None:
    """Binary STL, its normals those of the faces; `origin` (3,) is taken off, and named in it.

    Raises OSError.
    """
    points, faces = mesh
    corners = (points - origin)[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    record = np.zeros(
        len(faces), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("none", "<u2")])
    )
    record["normal"] = normal / np.where(length > 0, length, 1.0)
    record["corners"] = corners
    header = f"doseki {about}; m; origin {_text(origin)}".encode("ascii", "replace")
    with path.open("wb") as file:
        file.write(header[:80].ljust(80))
        file.write(np.uint32(len(faces)).astype("<u4").tobytes())
        file.write(record.tobytes())


def write_ply(
    path: Path,
    mesh: Triangles,
    origin: np.ndarray,
    fields: Mapping[str, np.ndarray],
    comments: Sequence[str],
) -> None:
    """Binary PLY in double precision, with scalars of the vertices; raises OSError."""
    points, faces = mesh
    columns = {axis: (points - origin)[:, k] for k, axis in enumerate("xyz")} | dict(fields)
    vertices = np.zeros(len(points), np.dtype([(name, "<f8") for name in columns]))
    for name, values in columns.items():
        vertices[name] = values
    polygons = np.zeros(len(faces), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    polygons["count"], polygons["corners"] = 3, faces
    head = [
        "ply", "format binary_little_endian 1.0",
        *(f"comment {line}" for line in comments),
        f"comment origin {_text(origin)} is to be added to x y z",
        f"element vertex {len(points)}", *(f"property double {name}" for name in columns),
        f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header", "",
    ]  # fmt: skip
    with path.open("wb") as file:
        file.write("\n".join(head).encode("ascii", "replace"))
        file.write(vertices.tobytes())
        file.write(polygons.tobytes())


def _text(origin: np.ndarray) -> str:
    return " ".join(f"{x:.0f}" for x in origin)
