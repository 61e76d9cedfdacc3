"""How a command ends: every exception becomes one sentence and an exit code, in one place."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from ..errors import DosekiError, Interrupted, PhysicsError, ResourceError, UserError

# Of the machine, not of what was asked for.
EXHAUSTED = {
    errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.ENOMEM, errno.EMFILE, errno.ENFILE, errno.EAGAIN,
    errno.EIO,
}  # fmt: skip
MISTAKE = 1


def said(error: BaseException) -> tuple[str, int]:
    """An error as a sentence and an exit code."""
    if isinstance(error, DosekiError | Interrupted):
        return str(error), error.exit_code
    if isinstance(error, MemoryError):
        return "out of memory", ResourceError.exit_code
    if isinstance(error, OSError):
        return _said_of_system(error)
    # The core has classes of its own, one for each instruction set.
    if (name := type(error).__name__) in ("PhysicsFailure", "ResourceFailure"):
        kind = PhysicsError if name == "PhysicsFailure" else ResourceError
        return str(kind(str(error))), kind.exit_code
    text = " ".join(f"{name}: {error}".split())
    return f"a mistake in doseki itself: {text} (--debug shows where)", MISTAKE


def _said_of_system(error: OSError) -> tuple[str, int]:
    """What the operating system refuses is a matter of its paths or of its resources."""
    kind = ResourceError if error.errno in EXHAUSTED else UserError
    place = f"{os.fsdecode(error.filename)}: " if error.filename is not None else ""
    return str(kind(f"{place}{error.strerror or error}")), kind.exit_code


def prepare_output() -> None:
    """Let any name be printed, whatever the encoding of the terminal."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]


@contextmanager
def flushed_output() -> Iterator[None]:
    """Print at the end what is still held back; raises OSError where it cannot be printed."""
    yield
    if sys.stdout is not None and not sys.stdout.closed:
        sys.stdout.flush()


def drop_output() -> None:
    """Give up on output that cannot be printed, so that Python does not complain at its end."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except OSError:
                os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
