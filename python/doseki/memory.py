"""How much memory a run may count on."""

from __future__ import annotations

import os
from pathlib import Path


def available_bytes() -> int:
    """Bytes that can be allocated now without swapping."""
    try:
        with Path("/proc/meminfo").open(encoding="ascii") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
