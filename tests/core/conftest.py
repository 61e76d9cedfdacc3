"""Cores to test, and simulations made with them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from doseki.solver.build import load_core

from .flows import Flows
from .instruction_sets import INSTRUCTION_SETS
from .simulations import Simulations


@pytest.fixture(params=INSTRUCTION_SETS)
def any_core(request: pytest.FixtureRequest) -> ModuleType:
    """The compiled core, once for each instruction set of this machine."""
    return load_core(request.param)


@pytest.fixture
def core() -> Iterator[ModuleType]:
    """The core that runs use here, on one thread."""
    core = load_core()
    threads = core.threads()
    core.set_threads(1)
    yield core
    core.set_threads(threads)


@pytest.fixture
def simulate(core: ModuleType) -> Simulations:
    """Makes simulations with the core that runs use here."""
    return Simulations(core)


@pytest.fixture(params=[2, 3], ids=["2d", "3d"])
def dim(request: pytest.FixtureRequest) -> int:
    """Number of space dimensions."""
    return request.param


@pytest.fixture
def flows(tmp_path: Path) -> Flows:
    """Makes simulations of the resolved scheme from the texts of scenarios."""
    return Flows(tmp_path)
