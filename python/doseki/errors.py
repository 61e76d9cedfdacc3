"""The errors a user can meet; each carries the exit code of the command line."""


class DosekiError(Exception):
    """An error reported in one sentence, never as a traceback."""

    exit_code = 1

    def __init__(self, message: str) -> None:
        # A name or a value that is quoted may hold line breaks; the message has none.
        super().__init__(" ".join(message.splitlines()))


class UserError(DosekiError):
    """The input (scenario, option, file) is wrong."""

    exit_code = 2


class PhysicsError(DosekiError):
    """The computed state went wrong (a non-finite value, a lost particle)."""

    exit_code = 3


class ResourceError(DosekiError):
    """The machine ran out of something: memory, disk, threads."""

    exit_code = 4
