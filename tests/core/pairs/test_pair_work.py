"""The operations and bytes of a pair are those of the code that sums it."""

from __future__ import annotations

import pytest

from doseki.compiled import load_core

REAL = {"double": 8, "mixed": 4}
ENTRY = 4  # bytes of an entry in a list


def work(scheme, dim, precision="double", wide=False):
    return {row["sum"]: row for row in load_core().pair_work(scheme, dim, precision, wide)}


@pytest.mark.parametrize("dim", [2, 3])
def test_operations_of_the_velocity_gradient(dim):
    """By hand, as Eq. (9) is written: what is added is what the code has more of."""
    distance = {"sums": dim + dim - 1, "products": dim + dim, "roots": 1, "comparisons": 1}
    kernel = {"sums": 3, "products": 12 + (dim == 3), "comparisons": 1}
    gradient = {"sums": dim + dim * dim, "products": 1 + 2 * dim * dim}
    found = work("ueta2022", dim)["pass_1"]
    for name in ("sums", "products", "quotients", "roots", "comparisons"):
        expected = sum(part.get(name, 0) for part in (distance, kernel, gradient))
        assert found[name] == expected, name


@pytest.mark.parametrize("precision", REAL)
@pytest.mark.parametrize("dim", [2, 3])
def test_bytes_are_those_of_the_records(dim, precision):
    motion, stress = dim + 2, dim * (dim + 1) // 2 + 3  # v, m, 1/R; sigma/rho^2, rho, c, switch
    tensors = 2 * (dim * (dim + 1) // 2)
    turning = 1 if dim == 2 else 3
    fluid = 2 * dim + tensors + turning + 8
    real = REAL[precision]
    own = work("ueta2022", dim, precision)
    assert own["pass_1"]["bytes"] == ENTRY + (dim + motion) * real
    assert own["pass_2"]["bytes"] == ENTRY + (dim + motion + stress) * real
    resolved = work("resolved", dim, precision)
    for pairs in ("continuity", "pass_2"):
        assert resolved[pairs]["bytes"] == ENTRY + (dim + motion + fluid) * real


def test_the_kernel_of_the_scenario_counts():
    narrow, wide = (work("resolved", 3, wide=kernel)["pass_2"] for kernel in (False, True))
    assert wide["products"] > narrow["products"]
    assert wide["bytes"] == narrow["bytes"]


def test_unknown_schemes_are_refused():
    with pytest.raises(ValueError, match="unknown scheme"):
        work("none", 2)
