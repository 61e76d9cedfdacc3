"""What callers give, of the kind that it must be."""

from __future__ import annotations

import os
from numbers import Integral
from pathlib import Path
from typing import Any

from ..errors import UserError

MOST_THREADS = 4096


def path_of(value: Any, name: str) -> Path:
    """A path, of a word or of what stands for one."""
    if not isinstance(value, str | os.PathLike):
        raise UserError(f"{name} = {value!r}; allowed: a path")
    return Path(os.fsdecode(value))


def whole_number(name: str, value: Any, most: int = 2**62) -> int | None:
    """A number of things, which may be one of numpy; None stays None."""
    if value is None:
        return None
    count = 0 if isinstance(value, bool) or not isinstance(value, Integral) else int(value)
    if not 1 <= count <= most:
        raise UserError(f"{name} = {value!r}; allowed: a whole number from 1 on")
    return count


def thread_count(value: Any) -> int | None:
    """A number of threads; None is all cores."""
    return whole_number("threads", value, MOST_THREADS)
