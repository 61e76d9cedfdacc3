"""Numbers as text in a page: planes of bytes, deflated, in base64 (browser/unpack.js reads them).

Particles are put in the order of a Morton curve, and each number is written as the step from the
one before: neighbours on the curve are neighbours in space, so that steps are small.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence

import numpy as np

LEVEL = 9  # of deflate
WIDE = 65535  # the largest number of 16 bits


def wide(share: np.ndarray) -> np.ndarray:
    """Numbers of 16 bits for shares from 0 to 1; what is outside is brought to the ends."""
    return np.rint(np.clip(share, 0.0, 1.0) * WIDE).astype(np.uint16)


def small(share: np.ndarray) -> np.ndarray:
    """Numbers of 8 bits for shares from 0 to 1; what is not a number becomes 0."""
    return np.rint(np.clip(np.nan_to_num(share), 0.0, 1.0) * 255).astype(np.uint8)


def packed(planes: Sequence[np.ndarray]) -> str:
    """Base64 of arrays of uint8 or uint16, one after the other."""
    parts = [_wide_plane(p) if p.dtype == np.uint16 else _small_plane(p) for p in planes]
    return base64.b64encode(zlib.compress(b"".join(parts), LEVEL)).decode("ascii")


def _small_plane(values: np.ndarray) -> bytes:
    return np.diff(values, prepend=np.uint8(0)).astype(np.uint8).tobytes()


def _wide_plane(values: np.ndarray) -> bytes:
    """Low bytes, then high bytes, of the steps; their sign is the lowest bit."""
    step = np.diff(values, prepend=np.uint16(0)).astype(np.uint16).view(np.int16)
    folded = ((step << 1) ^ (step >> 15)).view(np.uint16)
    return (folded & 255).astype(np.uint8).tobytes() + (folded >> 8).astype(np.uint8).tobytes()


def morton_order(place: np.ndarray) -> np.ndarray:
    """The order (n,) of points (n, 3) of 16 bits along a Morton curve."""
    key = np.zeros(len(place), np.uint64)
    for axis in range(place.shape[1]):
        key |= _spread(place[:, axis]) << np.uint64(axis)
    return np.argsort(key, kind="stable")


def _spread(values: np.ndarray) -> np.ndarray:
    """The bits of numbers of 16 bits, two zeros between each and the next."""
    spread = values.astype(np.uint64)
    for shift, mask in (
        (16, 0x0000FF0000FF),
        (8, 0x00F00F00F00F),
        (4, 0x0C30C30C30C3),
        (2, 0x249249249249),
    ):
        spread = (spread | spread << np.uint64(shift)) & np.uint64(mask)
    return spread
