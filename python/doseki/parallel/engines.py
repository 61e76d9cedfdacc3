"""The decompositions that there are, and the choice among them."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ..errors import UserError
from ..util.spelling import suggestion
from .decomposition import Decomposition, Multisection
from .zoltan import ZoltanBisection, why_not

if TYPE_CHECKING:
    from mpi4py import MPI

CHOICE = "DOSEKI_DECOMPOSITION"  # environment variable
NAMES = ("auto", "zoltan", "multisection")


def chosen_engine(comm: MPI.Intracomm, dim: int) -> Decomposition:
    """Zoltan's bisection where it is built and fits the MPI in use, else multisection.

    DOSEKI_DECOMPOSITION names one of them; raises UserError where it cannot be had.
    """
    wish = os.environ.get(CHOICE, "auto")
    if wish not in NAMES:
        raise UserError(
            f"{CHOICE}={wish}: must be one of {', '.join(NAMES)}{suggestion(wish, NAMES)}"
        )
    reason = why_not()
    if wish == "zoltan" and reason:
        raise UserError(f"{CHOICE}=zoltan: {reason}")
    if wish == "multisection" or reason:
        return Multisection(comm, dim)
    return ZoltanBisection(comm, dim)
