"""doseki: debris flows by smoothed particle hydrodynamics, water and rock solved as continua."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api.record import Run as Run
    from .api.record import load as load
    from .api.scenario import Scenario as Scenario
    from .api.simulate import resume as resume
    from .api.simulate import run as run
    from .driver.live import LiveView as LiveView
    from .errors import DosekiWarning as DosekiWarning
    from .errors import PhysicsError as PhysicsError
    from .errors import ResourceError as ResourceError
    from .errors import UserError as UserError
    from .running.runner import run_scenario as run_scenario
    from .scenario.load import list_scenarios as list_scenarios
    from .scenario.load import load_scenario as load_scenario

    __version__: str

# Imported on first use: reading a scenario or a record must not wait for the compiled core.
_LAZY = {
    "Scenario": "api.scenario",
    "run": "api.simulate",
    "resume": "api.simulate",
    "load": "api.record",
    "Run": "api.record",
    "LiveView": "driver.live",
    "list_scenarios": "scenario.load",
    "load_scenario": "scenario.load",
    "run_scenario": "running.runner",
    "UserError": "errors",
    "PhysicsError": "errors",
    "ResourceError": "errors",
    "DosekiWarning": "errors",
}

__all__ = ["__version__", *_LAZY]  # noqa: PLE0604 (names of lazily imported attributes)

if not TYPE_CHECKING:  # which knows the names above, and is to miss all others

    def __getattr__(name: str) -> Any:
        if name == "__version__":
            return import_module(".version", __name__).version()
        if name not in _LAZY:
            raise AttributeError(f"module 'doseki' has no attribute {name!r}")
        return getattr(import_module(f".{_LAZY[name]}", __name__), name)

    def __dir__() -> list[str]:
        return sorted({*globals(), *_LAZY, "__version__"})
