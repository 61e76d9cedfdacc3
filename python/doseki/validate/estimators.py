"""Numbers read from states: amplitudes, profiles, fronts, levels, pressures at a sensor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .running import State


def kinetic_energy(state: State) -> float:
    """Of the given particles, J (2-D: J/m)."""
    return 0.5 * float(np.sum(state["mass"] * np.sum(state["velocity"] ** 2, axis=1)))


def volume(state: State) -> float:
    """Sum of m/rho, m3 (2-D: m2)."""
    return float(np.sum(state["mass"] / state["density"]))


def angular_momentum(state: State) -> float:
    """About the origin, 2-D, counted counter-clockwise, kg m/s."""
    return float(np.sum(state["mass"] * moments(state["position"], state["velocity"])))


def moments(lever: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """lever x vector (n,) of vectors of the plane (n, 2)."""
    return np.asarray(lever[:, 0] * vector[:, 1] - lever[:, 1] * vector[:, 0])


def mean_velocity(state: State, axis: int = 0) -> float:
    """Weighted with mass, m/s."""
    return float(np.average(state["velocity"][:, axis], weights=state["mass"]))


def wave_amplitude(state: State, component: int, axis: int, k: float) -> float:
    """Amplitude of sin(k x_axis) in a component of the velocity."""
    phase = k * state["position"][:, axis]
    return float(2 * np.mean(state["velocity"][:, component] * np.sin(phase)))


def rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def crossings(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Times at which a sampled curve goes through zero, interpolated linearly."""
    k = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0)
    share = values[k] / (values[k] - values[k + 1])
    return times[k] + share * (times[k + 1] - times[k])


def front(state: State, dp: float, axis: int = 0) -> float:
    """Farthest reach of the particles along an axis, half a spacing beyond the last one."""
    return float(state["position"][:, axis].max() + dp / 2)


def level(state: State, at: Sequence[float], dp: float) -> float:
    """Height of the water over the horizontal point `at`; zero without water there."""
    x = state["position"]
    near = (np.abs(x[:, :-1] - np.asarray(at)) <= dp).all(axis=1)
    return float(x[near, -1].max() + dp / 2) if near.any() else 0.0


def pressure_at(wall: State, point: Sequence[float], dp: float) -> float:
    """Pressure at a point of the first row of a wall, from the particles less than dp away."""
    distance = np.linalg.norm(wall["position"] - np.asarray(point), axis=1)
    weight = np.maximum(0.0, 1 - distance / dp)
    return float(np.average(wall["pressure"], weights=weight))


def loose_share(state: State, reach: float, chunk: int = 500) -> float:
    """Share of the particles with fewer than three others within `reach`: none in one piece."""
    x, loose = state["position"], 0
    for start in range(0, len(x), chunk):
        gaps = x[start : start + chunk, None, :] - x[None, :, :]
        near = (np.einsum("ijk,ijk->ij", gaps, gaps) < reach**2).sum(axis=1) - 1
        loose += int((near < 3).sum())
    return loose / len(x)


def largest_cluster(position: np.ndarray, reach: float) -> np.ndarray:
    """The points (N, dim) of the largest set in which neighbours are nearer than `reach`."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(position).query_pairs(reach, output_type="ndarray")
    n = len(position)
    graph = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    return position[label == np.argmax(np.bincount(label))]


def surface_slope(
    position: np.ndarray, bin_width: float, length: float, crest: float = 0.85
) -> tuple[float, np.ndarray, np.ndarray]:
    """The downward angle, rad, of the surface of a 2-D heap over 0 <= x <= length.

    A line through the highest point of each bin whose height is below `crest` of the highest; also
    these points: angle, x, y.
    """
    x, y = position.T
    cell = np.floor(x / bin_width).astype(int)
    cells = [k for k in range(int(length / bin_width)) if (cell == k).any()]
    best = [np.flatnonzero(cell == k)[np.argmax(y[cell == k])] for k in cells]
    flank = [p for p in best if y[p] < crest * y[best].max()]
    return float(np.arctan(-np.polyfit(x[flank], y[flank], 1)[0])), x[best], y[best]
