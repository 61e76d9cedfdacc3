"""Texts whose last line holds a digest of the others, so that a change by hand is noticed."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

from ..errors import UserError
from .foreign import read_text

SEAL = "# BLAKE2b of the lines above: "


def sealed(text: str) -> str:
    """The text and its seal, a comment."""
    whole = text if text.endswith("\n") else text + "\n"
    return f"{whole}{SEAL}{_digest(whole)}\n"


def check_seal(path: Path) -> bool:
    """Whether a file has a seal; one without is taken as it is.

    Raises UserError where it has been changed since it was sealed.
    """
    is_sealed, is_whole = _looked_at(path)
    if not is_whole:
        raise UserError(
            f"{path}: has been changed by hand since the run wrote it; bring it back (what may "
            "change is changed by --set), or remove its last line to go on with it as it is"
        )
    return is_sealed


def changed_by_hand(path: Path) -> str | None:
    """What is to be said of a scenario that has been changed since a run wrote it.

    Raises UserError where it cannot be read.
    """
    if _looked_at(path)[1]:
        return None
    return (
        f"{path}: has been changed by hand since the run wrote it, so that what it says may not be "
        "what was run; bring it back"
    )


def _looked_at(path: Path) -> tuple[bool, bool]:
    """Whether a file has a seal, and whether it is as it was when it got one, if it has."""
    text = read_text(path)
    found = re.search(rf"^{SEAL}([0-9a-f]*)\s*\Z", text, re.MULTILINE)
    return found is not None, not found or found[1] == _digest(text[: found.start()])


def _digest(text: str) -> str:
    return hashlib.blake2b(text.encode("utf-8"), digest_size=16).hexdigest()
