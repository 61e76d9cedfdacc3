"""doseki: debris flows by smoothed particle hydrodynamics, water and rock solved as continua."""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

# Imported on first use: reading a scenario or a record must not wait for the compiled core.
_LAZY = {
    "load": "record.reader",
    "load_scenario": "scenario.load",
    "run_scenario": "running.runner",
    "UserError": "errors",
    "PhysicsError": "errors",
    "ResourceError": "errors",
}

__all__ = ["__version__", *_LAZY]  # noqa: PLE0604 (names of lazily imported attributes)


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'doseki' has no attribute {name!r}")
    return getattr(import_module(f".{_LAZY[name]}", __name__), name)
