"""doseki, with space cut anew at every build of the lists, by weights drawn at random.

Any decomposition must give the same run, those too that measured costs lead to once in a while. The
seed is in ODD_CUTS.
"""

from __future__ import annotations

import os
from itertools import count

import numpy as np

from doseki.cli.main import main
from doseki.parallel.transport import Transport

STEEPNESS = 8.0  # of the weights, over a metre
CUTS = count()


def cut(transport: Transport, coordinates: np.ndarray, weights: np.ndarray) -> None:
    """Cuts into parts that differ much in size."""
    rng = np.random.default_rng([int(os.environ["ODD_CUTS"]), next(CUTS)])
    position = coordinates.reshape(-1, transport.dim)
    odd = np.exp(position @ rng.normal(size=transport.dim, scale=STEEPNESS))
    transport.decomposition.cut(position, odd)
    transport.balance.has_cut(0.0)


if __name__ == "__main__":
    Transport.wants_cuts = lambda transport, busy: True
    Transport.cut = cut
    main()
