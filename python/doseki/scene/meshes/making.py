"""The surface of a mesh file, made once however often it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from ...errors import UserError
from ...util.finding import Finding
from ...util.input_file import digest_of
from ..shapes import MeshShape, ShapeError, Triangles
from .layers import wall_layer
from .mending import closed, findings_of
from .reading import read_triangles

KEPT = 8  # meshes, and layers of particles


@dataclass(frozen=True)
class MadeMesh:
    """A surface, where the middle of its extent is in its file, m, and what is doubtful of it."""

    shape: MeshShape
    middle: np.ndarray  # (3,)
    doubts: Sequence[Finding]

    def findings(self, place: str) -> list[Finding]:
        """What is doubtful, as said of the body of that name."""
        return [replace(doubt, place=place) for doubt in self.doubts]


def made_mesh(file: Path, scale: float, thickness: float) -> MadeMesh:
    """A mesh file as a surface; a thickness above 0, m, makes a sheet of it.

    Raises ShapeError where the file cannot be read, or its surface is not closed and no sheet.
    """
    return _made(file, _digest(file), scale, thickness)


def _digest(file: Path) -> str:
    """What tells one content from another; raises ShapeError without a file."""
    try:
        return digest_of(file)
    except UserError as error:
        raise ShapeError(str(error)) from None


@lru_cache(maxsize=KEPT)
def _made(file: Path, digest: str, scale: float, thickness: float) -> MadeMesh:
    found = read_triangles(file, scale)
    mended = found if thickness else closed(file, found)
    middle = 0.5 * (mended.vertices.min(axis=0) + mended.vertices.max(axis=0))
    shape = MeshShape(Triangles(mended.vertices - middle, mended.faces), thickness)
    return MadeMesh(shape, middle, findings_of("", found, mended))


@lru_cache(maxsize=KEPT)
def wall_particles(shape: MeshShape, dp: float, depth: float) -> np.ndarray:
    """See layers.wall_layer."""
    return wall_layer(shape, dp, depth)
