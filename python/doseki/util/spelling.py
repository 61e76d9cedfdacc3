"""Suggestions for misspelt names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MAX_LISTED = 12
ALIKE, MAX_ALIKE = 0.5, 3  # share of letters in the same order; names at most


def suggestion(name: object, known: Iterable[str]) -> str:
    """`; did you mean X?`, or what is known when nothing is near: of much only what is alike."""
    known = sorted(set(known))
    name = name if isinstance(name, str) else ""
    if near := _nearest(name, known, 1, 0.6):
        return f"; did you mean {near[0]}?"
    if len(known) <= MAX_LISTED:
        return f"; known: {', '.join(known)}" if known else ""
    alike = _nearest(name, known, MAX_ALIKE, ALIKE)
    return f"; nearest: {', '.join(sorted(alike))}" if alike else ""


def _nearest(name: str, known: list[str], most: int, cutoff: float) -> list[str]:
    """Those most like it, the likest first, whether in capitals or not."""
    spelt = {word.lower(): word for word in known}
    return [spelt[word] for word in difflib.get_close_matches(name.lower(), spelt, most, cutoff)]
