"""doseki, killed when it has opened, renamed or removed so many files of a folder.

Arguments: how many, the folder, and the arguments of doseki. So a run can be killed at any moment
of its work on the disk, however fast the machine is.
"""

from __future__ import annotations

import os
import signal
import sys
from typing import Any

from doseki.cli.main import main

EVENTS = ("open", "os.rename", "os.remove", "os.mkdir")
operations, folder = int(sys.argv[1]), sys.argv[2]


def count(event: str, arguments: tuple[Any, ...]) -> None:
    """Kills when it has been called so often."""
    global operations
    if event in EVENTS and str(arguments[0]).startswith(folder):
        operations -= 1
        if operations == 0:
            os.kill(os.getpid(), signal.SIGKILL)


sys.addaudithook(count)
main(sys.argv[3:])
