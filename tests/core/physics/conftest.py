"""The point functions of the core, for every instruction set, one number or one pack at a time."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import pytest

from doseki.solver.build import load_core

from ..instruction_sets import INSTRUCTION_SETS


class PointFunctions:
    """Calls the functions of core/physics on arrays."""

    def __init__(self, core: ModuleType, pack: bool) -> None:
        self.physics = core.physics
        self.pack = pack

    def __call__(self, name: str, *arguments: float | np.ndarray, dim: int = 0) -> np.ndarray:
        """Results (k, n) of the function `name` for arguments that broadcast to n values.

        `dim` is 2 or 3 for the functions that exist once for each dimension.
        """
        module = {0: self.physics, 2: self.physics.two, 3: self.physics.three}[dim]
        columns = [column.tolist() for column in np.atleast_1d(*np.broadcast_arrays(*arguments))]
        return np.array(getattr(module, name)(columns, self.pack))


@pytest.fixture(params=INSTRUCTION_SETS)
def core(request: pytest.FixtureRequest) -> ModuleType:
    """The compiled core, once for each instruction set of this machine."""
    return load_core(request.param)


@pytest.fixture
def physics(core: ModuleType) -> ModuleType:
    """The functions that no pair loop calls, as they are bound."""
    return core.physics


@pytest.fixture(params=[False, True], ids=["numbers", "packs"])
def point(core: ModuleType, request: pytest.FixtureRequest) -> PointFunctions:
    """The point functions on single numbers, then on packs."""
    return PointFunctions(core, request.param)


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request: pytest.FixtureRequest) -> int:
    """Number of space dimensions."""
    return request.param


@pytest.fixture
def random() -> np.random.Generator:
    """The same random numbers in every run."""
    return np.random.default_rng(20220)
