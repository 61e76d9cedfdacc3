"""What one run of a study came to: a row of its table, kept in a file beside the run."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...errors import UserError
from ...util.files import write_whole_text
from ...util.foreign import read_text

DONE, FAILED, LOST = "done", "failed", "lost"
STATUSES = (DONE, FAILED, LOST)
MAX_BYTES = 1_000_000


@dataclass(frozen=True)
class Row:
    """A run: whether it was done, and what was read of it.

    Attributes:
        status: done; failed, which it would again; or lost (killed, out of memory), which is
            tried again when the study goes on.
        reason: why it was not done.
        reading: digest of what was to be read of it.
        results, misfits: by name; nan where the run has none.
        score: how far it is from the observations; nan without any.
        seconds: of wall time.
        trust: verdict of the trust report; empty where there is none.

    """

    status: str
    reading: str
    reason: str = ""
    results: Mapping[str, float] = field(default_factory=dict)
    misfits: Mapping[str, float] = field(default_factory=dict)
    score: float = math.nan
    seconds: float = math.nan
    trust: str = ""


def write_row(path: Path, row: Row) -> None:
    """Write a row, whole or not at all."""
    table = {
        **vars(row),
        "results": {name: _plain(value) for name, value in row.results.items()},
        "misfits": {name: _plain(value) for name, value in row.misfits.items()},
        "score": _plain(row.score),
        "seconds": _plain(row.seconds),
    }
    write_whole_text(path, json.dumps(table, indent=1) + "\n")


def read_row(path: Path) -> Row | None:
    """The row of a run; None where there is none, or it is damaged, so that it is made again."""
    try:
        table = json.loads(read_text(path, MAX_BYTES))
        return _checked(table)
    except (UserError, ValueError, TypeError, KeyError, RecursionError):
        return None


def _checked(table: Any) -> Row:
    if not all(isinstance(part, dict) for part in (table, table["results"], table["misfits"])):
        raise TypeError
    words = {name: table[name] for name in ("status", "reading", "reason", "trust")}
    if not all(isinstance(word, str) for word in words.values()):
        raise TypeError
    if words["status"] not in STATUSES:
        raise ValueError
    return Row(
        **words,
        results={str(name): _number(value) for name, value in table["results"].items()},
        misfits={str(name): _number(value) for name, value in table["misfits"].items()},
        score=_number(table["score"]),
        seconds=_number(table["seconds"]),
    )


def _plain(value: float) -> float | None:
    """JSON has no nan."""
    return float(value) if math.isfinite(value) else None


def _number(value: Any) -> float:
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError
    return float(value)
