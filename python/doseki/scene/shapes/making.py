"""Convex shapes from sides, corners and files."""

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UserError
from ...scenario.values.types import LARGEST
from ...util.foreign import read_bytes, readable
from .convex import Convex
from .outline import BULGE, FLAT
from .stl import readable_stl

LARGEST_STL = 50_000_000  # bytes
MOST_SIDES = 10_000


class ShapeError(UserError):
    """A polygon or a mesh that cannot be a body."""


def box_shape(sides: np.ndarray) -> Convex:
    """A rectangle or cuboid with these sides."""
    if len(sides) == 2:
        corners = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
        return polygon_shape(corners * sides)[0]
    import trimesh

    return _from_mesh(trimesh.creation.box(extents=sides))[0]


def polygon_shape(corners: np.ndarray) -> tuple[Convex, np.ndarray]:
    """A convex polygon from its corners (n, 2) in order, and its centre of mass.

    Raises ShapeError where the corners are not those of a convex polygon.
    """
    origin = corners[0]  # coordinates of a map are large against a body
    corners = corners - origin
    x, y = corners.T
    after = np.roll(corners, -1, axis=0)
    cross = x * after[:, 1] - y * after[:, 0]
    area, size = 0.5 * cross.sum(), float(np.ptp(corners, axis=0).max())
    if abs(area) < FLAT * size**2 or (after == corners).all(axis=1).any():
        raise ShapeError("its corners enclose no area, or two of them are the same")
    if area < 0:
        return polygon_shape(corners[::-1] + origin)
    centre = ((corners + after) * cross[:, None]).sum(axis=0) / (6 * area)
    vertices = corners - centre
    after = np.roll(vertices, -1, axis=0)
    side, next_side = after - vertices, np.roll(after - vertices, -1, axis=0)
    bend = side[:, 0] * next_side[:, 1] - side[:, 1] * next_side[:, 0]
    turns = np.arctan2(bend, (side * next_side).sum(axis=1)).sum()
    if (bend < -BULGE * size**2).any() or turns > 3 * np.pi:
        raise ShapeError("it is not convex")
    cross = vertices[:, 0] * after[:, 1] - vertices[:, 1] * after[:, 0]
    square = (vertices**2).sum(1) + (vertices * after).sum(1) + (after**2).sum(1)
    inertia = np.diag([0, 0, float((cross * square).sum() / 12 / area)])
    index = np.arange(len(vertices))
    faces = np.stack([index, np.roll(index, -1)], axis=1).astype(np.int32)
    return Convex(vertices, faces, float(area), inertia), centre + origin


def mesh_shape(file: Path, scale: float) -> tuple[Convex, np.ndarray]:
    """The polyhedron in an STL file, and its centre of mass in the file's frame, m.

    Raises ShapeError where the file cannot be read, or its surface is not closed or not convex.
    """
    try:
        content = read_bytes(file, LARGEST_STL)
        with readable(file, kind="STL"), quiet():
            mesh = _closed_mesh(file, content, scale)
    except UserError as error:
        raise ShapeError(str(error)) from None
    with quiet():
        shape, centre = _from_mesh(mesh)
    if (sides := len(shape.outline.distance)) > MOST_SIDES:
        raise ShapeError(
            f"the surface in {file} has {sides} plane sides, {len(shape.faces)} triangles; at most "
            f"{MOST_SIDES} are taken, as each particle is held against each; simplify it, or if "
            'the body is fixed take it as shape = "mesh"'
        )
    if (beyond := shape.bulge) > BULGE * shape.reach:
        raise ShapeError(
            f"the surface in {file} is not convex (by {beyond:.3g} m); cut it into convex bodies"
        )
    return shape, centre


@contextmanager
def quiet() -> Iterator[None]:
    """Keep what is said of a file that somebody has damaged to the sentence that refuses it."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)


def _closed_mesh(file: Path, content: bytes, scale: float) -> Any:
    import trimesh

    mesh = trimesh.load_mesh(io.BytesIO(readable_stl(file, content)), file_type="stl")
    with np.errstate(over="ignore"):
        farthest = float(np.abs(mesh.vertices * scale).max(initial=0.0))
    if not farthest <= LARGEST:
        raise UserError(f"{file}: a vertex is beyond {LARGEST:g} m")
    mesh.merge_vertices()
    if len(mesh.faces) < 4 or not mesh.is_watertight:
        raise UserError(f"the surface in {file} is not closed")
    if not mesh.nondegenerate_faces().all():
        raise UserError(f"the surface in {file} has triangles without area")
    mesh.faces = _outwards(np.array(mesh.vertices), np.array(mesh.faces))
    mesh.apply_scale(scale)
    return mesh


def _outwards(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Triangles of a convex surface with their normals outwards, whichever way they turned."""
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = np.einsum("md,md->m", normal, corners[:, 0] - corners.mean(axis=(0, 1)))
    return np.where((outward < 0)[:, None], faces[:, ::-1], faces)


def _from_mesh(mesh: Any) -> tuple[Convex, np.ndarray]:
    if not mesh.volume > 0:
        raise ShapeError("the surface encloses no volume")
    centre = np.array(mesh.center_mass, dtype=float)
    vertices = np.array(mesh.vertices, dtype=float) - centre
    inertia = np.array(mesh.moment_inertia, dtype=float) / float(mesh.mass)
    return Convex(vertices, np.array(mesh.faces, np.int32), float(mesh.volume), inertia), centre
