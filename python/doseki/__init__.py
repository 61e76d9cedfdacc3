"""doseki: debris flows by smoothed particle hydrodynamics, water and rock solved as continua."""

from importlib import import_module
from typing import Any

# Imported on first use: reading a scenario or a record must not wait for the compiled core.
_LAZY = {
    "load": "record.reader",
    "load_scenario": "scenario.load",
    "run_scenario": "run.runner",
    "UserError": "errors",
    "PhysicsError": "errors",
    "ResourceError": "errors",
}

__all__ = ["__version__", *_LAZY]  # noqa: PLE0604 (names of lazily imported attributes)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return _version()
    if name not in _LAZY:
        raise AttributeError(f"module 'doseki' has no attribute {name!r}")
    return getattr(import_module(f".{_LAZY[name]}", __name__), name)


def _version() -> str:
    """The version that was installed, which is that of its tag; of bare sources it is unknown."""
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("doseki")
    except PackageNotFoundError:
        return "0+unknown"
