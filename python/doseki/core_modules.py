"""The compiled core: which instruction set runs here."""

from __future__ import annotations

import os
import platform
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from .errors import UserError

# What a module was compiled for, and the processor flags that must be there for it.
INSTRUCTION_SETS = {
    "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
    "v3": {"avx2", "fma", "bmi1", "bmi2", "f16c"},
    "native": set(),
    "scalar": set(),
}

# How long a thread that waits for the others spins before it sleeps.  OpenMP's own choice, some
# milliseconds, makes a run many times slower as soon as another program wants one of its cores.
SPIN_COUNT = "2000"


def _processor_flags() -> set[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return set()
    return next((set(line.split()) for line in lines if line.startswith("flags")), set())


def available_instruction_sets() -> list[str]:
    """Instruction sets that were built and that this processor has, fastest first."""
    flags = _processor_flags()
    return [
        isa
        for isa, needed in INSTRUCTION_SETS.items()
        if needed <= flags and find_spec(f"doseki._core_{isa}") is not None
    ]


@cache
def load_core(isa: str | None = None) -> ModuleType:
    """The extension module for an instruction set.

    `isa` is "v4" (AVX-512), "v3" (AVX2), "native" (other processors) or "scalar" (one lane, the
    reference); by default the environment variable DOSEKI_ISA, else the fastest one available.
    Raises UserError when it is not available here.
    """
    available = available_instruction_sets()
    chosen = isa or os.environ.get("DOSEKI_ISA") or (available[0] if available else None)
    if chosen not in available:
        raise UserError(
            f"instruction set {chosen!r} is not available on this {platform.machine()} processor;"
            f" built and usable here: {', '.join(available) or 'none (is the core built?)'}"
        )
    os.environ.setdefault("GOMP_SPINCOUNT", SPIN_COUNT)
    return import_module(f"doseki._core_{chosen}")
