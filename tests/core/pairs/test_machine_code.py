"""What the compiler makes of the pair loops: a call in one of them costs several times the sum."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from doseki.compiled import load_core

ROOT = Path(__file__).parents[3]
RESOLVED = ("resolved_2_double", "resolved_3_double", "resolved_2_mixed", "resolved_3_mixed")
LOOPS = dict.fromkeys(RESOLVED, ("::sum_group<", "::pick<"))
LOOPS |= dict.fromkeys(("ueta2022_2_double", "ueta2022_3_mixed"), ("sum_over_list<",))


def calls(unit: Path) -> dict[str, int]:
    """Number of calls in each function of an object file, by its name."""
    listing = subprocess.run(
        ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", unit],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    found: dict[str, int] = {}
    name = ""
    for line in listing.splitlines():
        if head := re.match(r"^[0-9a-f]+ <(.*)>:$", line):
            name = head[1]
            found[name] = 0
        elif re.search(r"\tcall", line):
            found[name] += 1
    return found


@pytest.mark.skipif(shutil.which("objdump") is None, reason="objdump is not installed")
@pytest.mark.parametrize("name", LOOPS)
def test_the_loop_over_a_list_calls_nothing(name):
    module = load_core().__name__.rpartition(".")[2]
    pattern = f"*/CMakeFiles/{module}_compute.dir/{name}_right_hand_side.cpp.o"
    units = sorted((ROOT / "build").glob(pattern))
    if not units:
        pytest.skip("an installed package: its objects are not here")
    found = calls(units[0])
    for loop in LOOPS[name]:
        loops = {
            function: count
            for function, count in found.items()
            if loop in function and "::{lambda" not in function
        }
        assert len(loops) >= 2
        assert not any(loops.values()), loops
