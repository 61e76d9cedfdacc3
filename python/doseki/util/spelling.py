"""Suggestions for misspelt names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MAX_LISTED = 12


def suggestion(name: str, known: Iterable[str]) -> str:
    """`; did you mean X?`, or what is known (the nearest of it) when nothing is near."""
    known = sorted(set(known))
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    if near:
        return f"; did you mean {near[0]}?"
    if len(known) <= MAX_LISTED:
        return f"; known: {', '.join(known)}" if known else ""
    near = difflib.get_close_matches(name, known, n=MAX_LISTED, cutoff=0.0)
    return f"; nearest: {', '.join(near)}"
