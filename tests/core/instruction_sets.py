"""The instruction sets to test: that of this processor always, the others in their own tier."""

from __future__ import annotations

from typing import Any

import pytest

from doseki.compiled import available_instruction_sets, card_here

# Without a built core, tests fail where they load it, so that none is left out unnoticed.
BEST, *OTHERS = available_instruction_sets() or ["none"]
if card_here():
    OTHERS.append("cuda")
INSTRUCTION_SETS: list[Any] = [BEST, *(pytest.param(isa, marks=pytest.mark.isa) for isa in OTHERS)]
