"""What a figure says that has nothing to show."""

from __future__ import annotations


class NothingToDrawError(Exception):
    """A figure would be empty; says why."""
