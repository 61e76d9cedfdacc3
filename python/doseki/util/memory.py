"""How much memory a run may count on."""

from __future__ import annotations

import psutil


def available_bytes() -> int:
    """Bytes that can be allocated now without swapping."""
    return int(psutil.virtual_memory().available)
