"""Particles in space as shaded surfaces: solids opaque, water translucent."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import (
    distance_transform_edt,
    find_objects,
    gaussian_filter,
    grey_closing,
    label,
    maximum_filter,
    minimum_filter,
)

from ..layout import Extent

SWELL = 1.25  # radius of a ball over that of the particle: no holes between neighbours
SMOOTH = 1.0  # radii over which the surface of many balls is smoothed
LIGHT = np.array([-0.45, 0.55, 0.70])  # to the right, upwards, towards the viewer
AMBIENT = 0.45
STEEPEST = 3.0  # slope of a surface; edges have any
JUMP = 9.0  # pixels in depth, over three pixels: steeper than any surface
OVER_SOLID, OVER_NOTHING = 0.40, 0.75  # how much of what is behind water it covers
NOTHING = -1


@dataclass(frozen=True)
class Camera:
    """A parallel projection: unit vectors (3,) to the right, upwards and away from the viewer."""

    right: np.ndarray
    up: np.ndarray
    away: np.ndarray

    @classmethod
    def looking(cls, away: np.ndarray) -> Camera:
        """The camera that looks along `away`, upright; straight down the second axis is up."""
        away = away / np.linalg.norm(away)
        right = np.cross(away, [0.0, 0.0, 1.0])
        if np.linalg.norm(right) < 1e-9:
            right = np.array([1.0, 0.0, 0.0])
        right = right / np.linalg.norm(right)
        return cls(right, np.cross(right, away), away)

    def project(self, position: np.ndarray) -> np.ndarray:
        """Points (n, 2) of positions (n, 3)."""
        return position @ np.stack([self.right, self.up], axis=1)


@dataclass(frozen=True)
class Balls:
    """What is drawn: positions (n, 3), radii (n,), colours (n, 3) from 0 to 1.

    `smooth` balls (n,) are parts of something larger; `clear` ones (n,) are water.
    """

    position: np.ndarray
    radius: np.ndarray
    colour: np.ndarray
    smooth: np.ndarray
    clear: np.ndarray


@dataclass(frozen=True)
class Background:
    """What is behind balls: colours (rows, columns, 3) from 0 to 1, and how deep it is, pixels."""

    colour: np.ndarray
    depth: np.ndarray

    @classmethod
    def flat(cls, colour: np.ndarray) -> Background:
        """A picture behind everything."""
        return cls(colour, np.full(colour.shape[:2], np.inf))


def picture_shape(extent: Extent, width: int) -> tuple[int, int]:
    """Rows and columns of a picture of what `extent` holds, so many pixels wide."""
    return max(1, round((extent[3] - extent[2]) * width / (extent[1] - extent[0]))), width


def render(
    balls: Balls,
    camera: Camera,
    extent: Extent,
    width: int,
    background: Background | None = None,
) -> np.ndarray:
    """A picture (rows, `width`, 3) uint8 of what `extent` holds, in the camera's axes.

    What is behind it is white, or the `background`.
    """
    shape = picture_shape(extent, width)
    behind = background or Background(np.ones((*shape, 3)), np.full(shape, np.inf))
    picture, nearest = behind.colour.copy(), behind.depth.copy()
    for solid in (~balls.clear & balls.smooth, ~balls.clear & ~balls.smooth):
        colour, depth = _layer(balls, solid, camera, extent, shape)
        front = depth < nearest
        picture[front], nearest[front] = colour[front], depth[front]
    colour, depth = _layer(balls, balls.clear, camera, extent, shape)
    cover = np.where(np.isfinite(nearest), OVER_SOLID, OVER_NOTHING) * (depth < nearest)
    picture += cover[..., None] * (colour - picture)
    return np.round(255 * picture).astype(np.uint8)


def _layer(
    balls: Balls, chosen: np.ndarray, camera: Camera, extent: Extent, shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """Colours (rows, columns, 3), shaded, and depth in pixels, infinite where there is nothing."""
    smooth = bool(balls.smooth[chosen].any())
    radius = balls.radius[chosen] * (SWELL if smooth else 1.0)
    shown, depth = seen_balls(balls.position[chosen], radius, camera, extent, shape)
    there = shown != NOTHING
    colour = np.ones((*shape, 3))
    if there.any():
        pixel = (extent[1] - extent[0]) / shape[1]
        reach = SMOOTH * float(np.median(radius)) / pixel if smooth else 0.0
        shade = _shade(depth, there, reach)
        colour[there] = balls.colour[chosen][shown[there]] * shade[there, None]
    return colour, depth


def seen_balls(
    position: np.ndarray,
    radius: np.ndarray,
    camera: Camera,
    extent: Extent,
    shape: tuple[int, int],
) -> tuple[np.ndarray, np.ndarray]:
    """Which ball each pixel (rows, columns) shows, or NOTHING, and how deep it is, in pixels."""
    pixel = (extent[1] - extent[0]) / shape[1]
    points = (camera.project(position) - [extent[0], extent[3]]) / pixel * [1, -1]
    return nearest_balls(points, position @ camera.away / pixel, radius / pixel, shape)


def nearest_balls(
    points: np.ndarray, depth: np.ndarray, radius: np.ndarray, shape: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """Which ball each pixel (rows, columns) of `shape` shows, or NOTHING, and how deep it is.

    All in pixels: points (n, 2) are (column, row), depth (n,) grows away from the viewer.
    """
    place = np.floor(points).astype(int)[:, ::-1]  # row, column
    reach = np.ceil(radius).astype(int)
    pixels = shape[0] * shape[1]
    nearest, shown, found = np.full(pixels, np.inf), np.full(pixels, NOTHING), []
    for size in np.unique(reach):
        members = np.flatnonzero(reach == size)
        square = np.argwhere(np.ones((2 * size + 1, 2 * size + 1))) - size
        # Either a pixel of all balls at a time, or all pixels of a ball.
        if len(square) < len(members):
            pairs = ((members, offset) for offset in square)
        else:
            pairs = ((np.full(len(square), k), square) for k in members)
        for k, offset in pairs:
            below = radius[k] ** 2 - (offset**2).sum(axis=-1)
            at = place[k] + offset
            # At least the pixel in the middle, however small the ball.
            inside = (below >= 0) & (at >= 0).all(axis=1) & (at < shape).all(axis=1)
            pixel = at[inside] @ [shape[1], 1]
            k, there = k[inside], (depth[k] - _root(below))[inside]
            np.minimum.at(nearest, pixel, there)
            front = there == nearest[pixel]
            found.append((k[front], pixel[front], there[front]))
    for k, pixel, there in found:
        front = there == nearest[pixel]
        shown[pixel[front]] = k[front]
    return shown.reshape(shape), nearest.reshape(shape)


def _root(values: np.ndarray) -> np.ndarray:
    return np.sqrt(np.maximum(values, 0.0))


def _shade(depth: np.ndarray, there: np.ndarray, reach: float) -> np.ndarray:
    """How bright each pixel is, 0 to 1, by the slope of the surface, smoothed over `reach`."""
    deepest = depth[there].max()
    surface = np.where(there, depth, deepest)
    if reach > 0:
        # Gaps between balls are filled up to their tops.
        filled = -grey_closing(-surface, 2 * math.ceil(reach) + 1)
        surface = _smoothed(filled, there, reach)
    down, across = np.gradient(surface)
    slopes = np.clip(np.stack([across, -down], axis=-1), -STEEPEST, STEEPEST)
    facing = slopes @ LIGHT[:2] + LIGHT[2]
    facing /= np.sqrt(1 + (slopes**2).sum(axis=-1)) * np.linalg.norm(LIGHT)
    return AMBIENT + (1 - AMBIENT) * np.clip(facing, 0.0, 1.0)


def _smoothed(surface: np.ndarray, there: np.ndarray, reach: float) -> np.ndarray:
    """The mean of each face over `reach` pixels, but not over its edges, where others are behind.

    A face is what hangs together without a jump in depth.  Small ones stay as they are.
    """
    jump = maximum_filter(surface, 3) - minimum_filter(surface, 3)
    face, count = label(there & (jump < max(reach, JUMP)))
    if not count:
        return surface
    nearest = distance_transform_edt(face == 0, return_distances=False, return_indices=True)
    face = np.where(there, face[tuple(nearest)], 0)
    sizes, found = np.bincount(face.ravel(), minlength=count + 1), surface.copy()
    for number, box in enumerate(find_objects(face), 1):
        if box is not None and sizes[number] > (2 * reach) ** 2:
            mine = face[box] == number
            weight = gaussian_filter(mine.astype(float), reach, mode="constant")
            mean = gaussian_filter(np.where(mine, surface[box], 0.0), reach, mode="constant")
            found[box][mine] = mean[mine] / weight[mine]
    return found
