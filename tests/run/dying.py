"""doseki, killed when it has opened, renamed or removed so many files of a folder.

Arguments: how many, the folder, and the arguments of doseki. So a run can be killed at any moment
of its work on the disk, however fast the machine is. With "1-40-6" for how many, one process after
the other is killed six operations later, each with a folder of its own: FOLDER-1, FOLDER-7 ...
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

import doseki.running.runner  # noqa: F401 (imported once for all children)
from doseki.cli.main import main
from doseki.record.folder import RunFolder

EVENTS = ("open", "os.rename", "os.remove", "os.mkdir")


def run(operations: int, folder: str, arguments: list[str]) -> None:
    """Runs doseki until it is killed."""
    places = folder, str(RunFolder(Path(folder)).prepared.path)

    def count(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal operations
        if event in EVENTS and str(arguments[0]).startswith(places):
            operations -= 1
            if operations == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(count)
    main(arguments)


def run_each(numbers: range, folder: str, arguments: list[str]) -> None:
    """Runs doseki in children; this process computes nothing, or its threads would be missed."""
    for operations in numbers:
        one = f"{folder}-{operations}"
        if (child := os.fork()) == 0:
            try:
                run(operations, one, [one if word == folder else word for word in arguments])
            finally:
                os._exit(0)
        os.waitpid(child, 0)


numbers = [int(number) for number in sys.argv[1].split("-")]
if len(numbers) > 1:
    run_each(range(*numbers), sys.argv[2], sys.argv[3:])
else:
    run(numbers[0], sys.argv[2], sys.argv[3:])
