"""The version of doseki."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed


def version() -> str:
    """The version that was installed, which is that of its tag; of bare sources it is unknown."""
    try:
        return installed("doseki")
    except PackageNotFoundError:
        return "0+unknown"
