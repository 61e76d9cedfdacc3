"""Saying how far work has come that goes on before a run starts."""

from __future__ import annotations

from collections.abc import Callable

Tell = Callable[[str], None]  # what goes on now, and how far it is


def say_nothing(_text: str) -> None:
    """For whoever does not want to know."""
