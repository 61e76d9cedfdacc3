"""The ranks that a command runs on."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

from ..errors import UserError

if TYPE_CHECKING:  # the solver comes with it, which --help must not wait for
    from ..driver.ranks import OneRank

_joined: OneRank | None = None


def join(ranks: int | None) -> OneRank:
    """The ranks of this command; with `--ranks` outside mpiexec, this process only starts them."""
    global _joined
    from ..parallel.launch import join_ranks, launched_size, spawn

    if ranks is not None and launched_size() == 1 and ranks > 1:
        raise typer.Exit(spawn(ranks, sys.argv[1:]))
    if ranks is not None and ranks != launched_size():
        raise UserError(f"--ranks {ranks}: mpiexec has started {launched_size()}; leave it out")
    _joined = join_ranks()
    return _joined


def joined() -> OneRank | None:
    """Those that this process has joined, if any."""
    return _joined
