"""The errors a user can meet; each carries the exit code of the command line."""

from __future__ import annotations

from collections.abc import Sequence

LONGEST = 1000  # characters of a message


def one_line(message: str) -> str:
    """A message fit for a terminal: it may quote line breaks, terminal codes, or a novel."""
    line = " ".join(message.splitlines())
    line = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)
    return line if len(line) <= LONGEST else f"{line[: LONGEST // 2]} ... {line[-LONGEST // 2 :]}"


class DosekiError(Exception):
    """An error reported in one sentence, never as a traceback."""

    exit_code = 1

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


class UserError(DosekiError):
    """The input (scenario, option, file) is wrong."""

    exit_code = 2


class PhysicsError(DosekiError):
    """The computed state went wrong (a non-finite value, a lost particle).

    `kind` is the core's word for it, explained in assess.failure; `particle` is the id of the one
    to blame and `position` where it was (dim,), m: -1 and empty where it is none.
    """

    exit_code = 3

    def __init__(
        self, message: str, kind: str = "", particle: int = -1, position: Sequence[float] = ()
    ) -> None:
        super().__init__(message)
        self.kind, self.particle, self.position = kind, particle, tuple(position)


class ResourceError(DosekiError):
    """The machine ran out of something: memory, disk, threads."""

    exit_code = 4


class DosekiWarning(UserWarning):
    """Something doubtful about a scenario or a run, in one sentence with its remedy."""


class Interrupted(BaseException):
    """Ctrl-C, or another signal that ends a process, outside the steps of a run, which end in good
    order, or within one of several runs.

    Not for `except Exception`.
    """

    exit_code = 130  # as shells say

    def __init__(self, message: str = "interrupted", exit_code: int = exit_code) -> None:
        super().__init__(one_line(message))
        self.exit_code = exit_code
