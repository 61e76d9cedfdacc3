"""How fast errors fall with the number of particles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def fitted_order(resolutions: Sequence[float], errors: Sequence[float]) -> float | None:
    """p of |error| ~ resolution^-p by least squares of the logarithms.

    None with fewer than two resolutions, or where an error is zero or not finite.
    """
    sizes = np.abs(np.asarray(errors, dtype=float))
    if len(sizes) < 2 or not np.isfinite(sizes).all() or not sizes.all():
        return None
    return float(-np.polyfit(np.log(np.asarray(resolutions, dtype=float)), np.log(sizes), 1)[0])
