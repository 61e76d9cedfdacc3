"""How long the installed command line takes to start: processor time, the best of some attempts."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

ATTEMPTS = 15
DOSEKI = str(Path(sys.executable).with_name("doseki"))
COMMANDS = {
    "python alone": ([sys.executable, "-c", ""], None),
    "import doseki": ([sys.executable, "-c", "import doseki"], None),
    "import of the command line": ([sys.executable, "-c", "import doseki.cli.app"], 0.25),
    "doseki --version": ([DOSEKI, "--version"], None),
    "doseki --help": ([DOSEKI, "--help"], 0.40),
    "doseki run --help": ([DOSEKI, "run", "--help"], None),
}


def seconds(command: list[str]) -> float:
    """Of the processor, in user and system mode, that a command takes."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main() -> None:
    """Prints a line for each command; nothing is asserted, since the machine may be busy."""
    for name, (command, aim) in COMMANDS.items():
        best = min(seconds(command) for _ in range(ATTEMPTS))
        print(f"{name:28}{best:.3f} s" + (f", to be at most {aim:.2f} s" if aim else ""))


if __name__ == "__main__":
    main()
