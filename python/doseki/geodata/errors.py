"""What is wrong with a map: a value that cannot be, or a file that cannot be used."""

from __future__ import annotations

from types import ModuleType

from ..errors import UserError


class GeodataError(UserError, ValueError):
    """A raster, a polygon or a line that cannot be used as asked, in one sentence."""


def needed(module: str, path: object, what: str) -> ModuleType:
    """A module of the extra `terrain`; raises GeodataError where it is not installed."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        raise GeodataError(
            f"{path}: {what} needs {package}: pip install 'doseki[terrain]'"
        ) from None
