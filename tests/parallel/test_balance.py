"""Space is cut anew when that pays, by what particles cost."""

from __future__ import annotations

import numpy as np
import pytest

mpi4py = pytest.importorskip("mpi4py", reason="mpi4py is not installed: pip install doseki[mpi]")
mpi4py.rc.initialize = False  # the tests' own process is no rank

from mpi4py import MPI  # noqa: E402

from doseki.parallel.balance import Balance  # noqa: E402


class TwoRanks:
    """A communicator whose other rank always brings the same numbers."""

    size = 2

    def __init__(self) -> None:
        self.busy = 0.0  # of the other rank, s

    def Allreduce(self, _in_place, values, op):  # noqa: N802
        """In place, with the other rank's."""
        if op == MPI.SUM:
            values[0] += self.busy
        else:
            values[0] = max(values[0], self.busy)


@pytest.fixture
def ranks():
    """Two ranks, of which this is one."""
    return TwoRanks()


def test_the_first_cut_is_due_at_once(ranks):
    assert Balance(ranks).is_due(0.0)


def test_even_work_is_left_alone(ranks):
    balance = Balance(ranks)
    balance.has_cut(1e-3)
    ranks.busy = 1.0
    assert not any(balance.is_due(1.0) for _ in range(100))


def test_a_cut_is_due_when_waiting_has_cost_as_much(ranks):
    balance = Balance(ranks)
    balance.has_cut(1.0)
    ranks.busy = 0.5  # the mean is 0.75 s, so 0.25 s are lost each time
    assert [balance.is_due(1.0) for _ in range(5)] == [False, False, False, False, True]


def test_what_a_cut_cannot_mend_does_not_call_for_another(ranks):
    balance = Balance(ranks)
    for _ in range(2):
        balance.has_cut(0.1)
    ranks.busy = 0.8
    assert not any(balance.is_due(1.0) for _ in range(100))
    ranks.busy = 0.4
    assert any(balance.is_due(1.0) for _ in range(5))


def test_particles_that_cost_more_are_shared_out(work):
    """A block that moves beside as many fixed particles that nothing comes near."""
    found = work("uneven", 2)
    first, later = (np.array(found[name]) for name in ("first", "later"))
    assert first.sum() == later.sum() == found["moving"]
    assert first.min() == 0  # equal numbers: all that moves is on one rank
    assert later.min() > 0.3 * found["moving"]
