"""doseki, which gets a signal at a moment that does not depend on how fast the machine is.

Arguments: the number of the signal, the moment, and the arguments of doseki. A moment is
`import:N`, the Nth import, or `module:function`, the first call of a function of doseki.
"""

from __future__ import annotations

import os
import sys
from types import FrameType
from typing import Any

number, moment, arguments = int(sys.argv[1]), sys.argv[2], sys.argv[3:]
module, _, name = moment.partition(":")
imports = 0


def interrupt() -> None:
    """Ctrl-C, or another signal."""
    os.kill(os.getpid(), number)


def count(event: str, _arguments: tuple[Any, ...]) -> None:
    """Interrupts the Nth import."""
    global imports
    if event == "import":
        imports += 1
        if imports == int(name):
            interrupt()


def look(frame: FrameType, event: str, _argument: Any) -> None:
    """Interrupts the first call."""
    where = frame.f_globals.get("__name__"), frame.f_code.co_name
    if event == "call" and where == (f"doseki.{module}", name):
        sys.setprofile(None)
        interrupt()


from doseki.cli.main import main  # noqa: E402

if module == "import":
    sys.addaudithook(count)
else:
    sys.setprofile(look)
main(arguments)
