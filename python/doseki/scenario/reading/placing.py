"""A table of a part, moved, turned or mirrored: plain values, as a file would have them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..table import Table
from ..values.expressions import is_expression

# Points in space, vectors, and turning speeds, whatever part has them.
POINTS = ("centre", "position", "vertices", "pivot", "about")
CORNERS = ("min", "max")
VECTORS = ("velocity", "normal", "direction")
OF_SHAPE = ("normal",)  # of VECTORS, what `rotate` turns with the shape
SPINS = ("spin", "angular_velocity")
OF_SPACE = ("where", "clamped", "pressure", "displacement", "velocity")

# What says where the triangles of a file are.
OF_TRIANGLES = {"stl": "centre", "mesh": "position"}

Part = dict[str, Any]
Map = Callable[[np.ndarray], np.ndarray]


def moved(part: Part, shift: np.ndarray) -> Part:
    """The part moved by a vector (dim,), m."""
    if not np.any(shift):
        return part
    _refuse_fields(part)
    if (shape := part.get("shape")) in OF_TRIANGLES and OF_TRIANGLES[shape] not in part:
        raise ValueError(f"copies of a file of triangles need its {OF_TRIANGLES[shape]}")

    def move(x: np.ndarray) -> np.ndarray:
        return x + shift

    return _mapped(part, (*POINTS, *CORNERS), move)


def turned(part: Part, kind: type[Table], degrees: float, about: np.ndarray) -> Part:
    """The part turned about a point, from the first axis towards the last."""
    if degrees == 0:
        return part
    _refuse_fields(part)
    if "rotate_axis" in part:
        raise ValueError("a part with a rotate_axis has no turned copies")
    turn = _rotation(degrees, len(about))

    def go_round(x: np.ndarray) -> np.ndarray:
        return about + (x - about) @ turn.T

    turns_itself = "rotate" in kind.model_fields
    keys = tuple(key for key in VECTORS if not (turns_itself and key in OF_SHAPE))
    vectors = _mapped(_turned_spins(part, turn), keys, lambda v: v @ turn.T)
    if not turns_itself:
        if set(CORNERS) & set(kind.model_fields):
            raise ValueError("a box along the axes has no turned copies")
        return _mapped(vectors, POINTS, go_round)
    own = {key: vectors.pop(key) for key in ("motion",) if key in vectors}
    placed = vectors | {"rotate": degrees, "pivot": about.tolist()}
    if part.get("rotate", 0):
        anchor = _anchor(part)
        shift = go_round(anchor) - anchor
        placed = _mapped(vectors, (*POINTS, *CORNERS), lambda x: x + shift)
        placed["rotate"] = part["rotate"] + degrees
    return placed | {key: _mapped(value, POINTS, go_round) for key, value in own.items()}


def mirrored(part: Part, axis: int, at: float) -> Part:
    """The part mirrored across the plane in which the coordinate along `axis` is `at`, m."""
    _refuse_fields(part)
    if part.get("shape") in OF_TRIANGLES or "rotate_axis" in part:
        raise ValueError("an stl, a mesh, or a part with a rotate_axis has no mirrored copy")

    def reflect(x: np.ndarray) -> np.ndarray:
        x = x.copy()
        x[..., axis] = 2 * at - x[..., axis]
        return x

    def flip(v: np.ndarray) -> np.ndarray:
        v = v.copy()
        v[..., axis] *= -1
        return v

    found = _mapped(_mapped(part, VECTORS, flip), POINTS, reflect)
    for key in SPINS:
        found = _mapped(found, (key,), lambda w: -flip(w) if w.ndim else -w)
    if set(CORNERS) <= set(part):
        ends = [reflect(np.array(part[key], dtype=float)) for key in CORNERS]
        found["min"] = np.minimum(*ends).tolist()
        found["max"] = np.maximum(*ends).tolist()
    if part.get("rotate", 0):
        anchor = _anchor(part)
        found["pivot"] = reflect(anchor).tolist()
        if axis in (0, len(anchor) - 1):
            found["rotate"] = -part["rotate"]
    return found


def _anchor(part: Part) -> np.ndarray:
    """The point about which a part is rotated."""
    for key in ("pivot", "min", "centre"):
        if key in part:
            return np.array(part[key], dtype=float)
    raise ValueError("copies of a part with rotate need its pivot")


def _rotation(degrees: float, dim: int) -> np.ndarray:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.eye(dim)
    turn[0, 0], turn[0, -1], turn[-1, 0], turn[-1, -1] = cos, -sin, sin, cos
    return turn


def _turned_spins(part: Part, turn: np.ndarray) -> Part:
    """Turning speeds are vectors in 3-D alone."""
    return _mapped(part, SPINS, lambda w: w @ turn.T if w.ndim else w)


def _mapped(part: Part, keys: tuple[str, ...], change: Map) -> Part:
    """The part with the values of some keys changed, those of tables in it too."""
    found = {}
    for key, value in part.items():
        if isinstance(value, dict):
            found[key] = _mapped(value, keys, change)
        elif key in keys:
            found[key] = change(_numbers(value)).tolist()
        else:
            found[key] = value
    return found


def _numbers(value: Any) -> np.ndarray:
    try:
        return np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"copies need numbers, not {repr(value)[:60]}") from None


def _refuse_fields(part: Part) -> None:
    """An expression of x, y, z means the same place for all copies: that is never meant."""
    for key in OF_SPACE:
        entries = part.get(key)
        for entry in entries if isinstance(entries, list) else [entries]:
            if is_expression(entry):
                raise ValueError(f'copies of a part whose {key} depends on x, y, z: "{entry}"')
