"""Packages that doseki can do without, and that are named where they are missed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import UserError


@contextmanager
def extra(name: str, what: str) -> Iterator[None]:
    """Around imports of the extra `name`, for `what`: UserError where they are not installed."""
    try:
        yield
    except ImportError as error:
        missing = error.name or name
        raise UserError(f"{what} needs {missing}: pip install 'doseki[{name}]'") from None
