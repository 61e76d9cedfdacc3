"""What is wrong with a map: a value that cannot be, or a file that cannot be used."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from ..errors import UserError


class GeodataError(UserError, ValueError):
    """A raster, a polygon or a line that cannot be used as asked, in one sentence."""


class WindowError(GeodataError):
    """A window that is empty, or reaches beyond its raster."""


def needed(module: str, path: object, what: str) -> ModuleType:
    """A module of the extra `terrain`; raises GeodataError where it is not installed."""
    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        raise GeodataError(
            f"{path}: {what} needs {package}: pip install 'doseki[terrain]'"
        ) from None
