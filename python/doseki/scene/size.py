"""Whether there is room for the particles that a scenario asks for."""

from __future__ import annotations

from collections.abc import Mapping

from ..errors import ResourceError
from ..util.memory import available_bytes

MAX_PARTICLES = 2_000_000_000
BYTES_PER_PARTICLE = 500  # what a run holds, lists included


def check_size(counts: Mapping[str, float]) -> None:
    """Refuse what cannot be held, before anything is allocated.

    Args:
        counts: particles of each table, such as "body.water".

    Raises:
        ResourceError: they are too many for this program, or for the memory of this machine.

    """
    total, free = sum(counts.values()), available_bytes()
    if total > MAX_PARTICLES or total * BYTES_PER_PARTICLE > free:
        largest = max(counts, key=lambda name: counts[name])
        raise ResourceError(
            f"the scenario asks for {total:.3g} particles ({counts[largest]:.3g} of them in "
            f"{largest}), about {total * BYTES_PER_PARTICLE / 2**30:.3g} GiB; at most "
            f"{min(MAX_PARTICLES, free / BYTES_PER_PARTICLE):.3g} fit: increase dp"
        )
