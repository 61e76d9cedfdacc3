"""Random packings of balls in a box, without overlap.  Lengths in any one unit."""

from __future__ import annotations

import numpy as np

# Radii are blown up by this while overlaps are relaxed away, so that they end above nothing.
MARGIN = 2e-3
SKIN = 0.15  # of the mean diameter: margin of the pair lists
STEPS = 400  # of one minimisation
ATTEMPTS = 6  # each from the last arrangement, shaken
SHAKE = 0.05  # of the mean diameter


class PackingError(ValueError):
    """A solid fraction that cannot be reached; `reached` is what was."""

    def __init__(self, reached: float) -> None:
        super().__init__(f"a solid fraction of {reached:.3f} was reached")
        self.reached = reached


def pack(radius: np.ndarray, low: np.ndarray, high: np.ndarray, seed: int) -> np.ndarray:
    """Centres (N, dim) of balls of `radius` (N,) that lie in the box and do not overlap.

    Random positions whose overlaps are relaxed away: a minimum of the elastic energy of soft balls
    (O'Hern, Silbert, Liu & Nagel 2003).  Raises PackingError where none is found.
    """
    if np.any(high - low < 2 * radius.max()):
        raise PackingError(0.0)
    random = np.random.default_rng(seed)
    wall = radius[:, None]
    centre, best = random.uniform(low + wall, high - wall), 0.0
    for _ in range(ATTEMPTS):
        soft = _SoftBalls(radius * (1 + MARGIN), low + wall, high - wall)
        centre = soft.relaxed(centre)
        closest = _closeness(centre, radius)
        if closest >= 1:
            return centre
        best = max(best, closest)
        shaken = centre + SHAKE * 2 * radius.mean() * random.uniform(-1, 1, centre.shape)
        centre = np.clip(shaken, low + wall, high - wall)
    raise PackingError(solid_fraction(radius, low, high) * best ** len(low))


def solid_fraction(radius: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    """Share of the box that the balls fill."""
    ball = np.pi if len(low) == 2 else 4 / 3 * np.pi
    return float(ball * (radius ** len(low)).sum() / np.prod(high - low))


def _closeness(centre: np.ndarray, radius: np.ndarray) -> float:
    """Smallest distance of two balls over the sum of their radii; inf without neighbours."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(centre).query_pairs(2 * radius.max(), output_type="ndarray")
    i, j = pairs.T
    distance = np.linalg.norm(centre[i] - centre[j], axis=1)
    return float((distance / (radius[i] + radius[j])).min(initial=np.inf))


class _SoftBalls:
    """Balls that repel where they overlap; centres stay within bounds."""

    def __init__(self, radius: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
        self.radius, self.low, self.high = radius, low, high
        self.scale = 2 * float(radius.mean())
        self._listed_at: np.ndarray | None = None
        self._worst = np.inf  # overlap over the sum of radii, where the energy was taken last

    def relaxed(self, centre: np.ndarray) -> np.ndarray:
        """Centres at a minimum of the energy, or where no true overlap is left."""
        from scipy.optimize import minimize
        from threadpoolctl import threadpool_limits

        def stop(_: np.ndarray) -> None:
            if self._worst < 0.99 * MARGIN:
                raise StopIteration

        bounds = np.stack([self.low.ravel(), self.high.ravel()], axis=1) / self.scale
        with threadpool_limits(1):  # threads that wait for one another take forty times as long
            found = minimize(
                self._energy,
                centre.ravel() / self.scale,
                jac=True,
                method="L-BFGS-B",
                bounds=bounds,
                callback=stop,
                options={"maxiter": STEPS, "maxfun": 2 * STEPS, "ftol": 0.0, "gtol": 1e-9},
            )
        return found.x.reshape(centre.shape) * self.scale

    def _energy(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        centre = x.reshape(-1, self.low.shape[1]) * self.scale
        self._update_list(centre)
        i, j, reach = self._pairs
        offset = centre.take(i, axis=0) - centre.take(j, axis=0)
        square = np.einsum("nd,nd->n", offset, offset)
        near = np.flatnonzero(square < reach**2)
        i, j, reach, offset = i[near], j[near], reach[near], offset[near]
        distance = np.sqrt(square[near])
        overlap = (reach - distance) / self.scale
        self._worst = float((1 - distance / reach).max(initial=0.0))
        pull = (-overlap / distance)[:, None] * offset
        n = len(centre)
        gradient = np.stack([np.bincount(i, f, n) - np.bincount(j, f, n) for f in pull.T], axis=1)
        return 0.5 * float(overlap @ overlap), gradient.ravel()

    def _update_list(self, centre: np.ndarray) -> None:
        from scipy.spatial import cKDTree

        skin = SKIN * self.scale
        if self._listed_at is not None:
            moved = np.abs(centre - self._listed_at).max(initial=0.0)
            if 2 * moved * np.sqrt(centre.shape[1]) < skin:
                return
        reach = 2 * self.radius.max() + skin
        i, j = cKDTree(centre).query_pairs(reach, output_type="ndarray").T
        touch = self.radius[i] + self.radius[j]
        near = np.linalg.norm(centre[i] - centre[j], axis=1) < touch + skin
        self._pairs, self._listed_at = (i[near], j[near], touch[near]), centre.copy()
