"""The reference of the Python interface, from its docstrings."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import doseki

# Beside what `import doseki` offers: modules that pages of this documentation tell to use.
MODULES = (
    "doseki.measure.series",
    "doseki.measure.hydrographs",
    "doseki.util.low_pass",
    "doseki.geodata.raster",
    "doseki.geodata.features",
)


def api_pages() -> Iterator[tuple[str, str]]:
    """The page of the Python interface."""
    exported = [name for name in doseki.__all__ if not name.startswith("__")]
    values = {name: getattr(doseki, name) for name in exported}
    parts = [INTRODUCTION, "## doseki"]
    parts += [_directive("doseki", name, value) for name, value in values.items()]
    if returned := list(_returned(values)):
        parts.append("## What these return")
        parts += [_directive(kind.__module__, kind.__name__, kind) for kind in returned]
    for name in MODULES:
        parts.append(f"## {name}\n\n" + _rst(f".. automodule:: {name}\n   :members:\n"))
    yield "reference/python-api.md", "\n\n".join(parts) + "\n"


INTRODUCTION = """\
# The Python interface

All arrays are NumPy's, in SI units. *N* is the number of particles, *dim* is 2 or 3. What is listed here is meant to be used from
other programs; everything else in the package may change without notice.

Mistakes of the user raise `doseki.UserError` with one sentence, physics that goes wrong `doseki.PhysicsError`, and a full disk or
memory `doseki.ResourceError`.
"""


def _rst(text: str) -> str:
    return f"```{{eval-rst}}\n{text}\n```"


def _directive(module: str, name: str, value: Any) -> str:
    if inspect.isclass(value) and issubclass(value, BaseException):
        return _rst(f".. autoexception:: {module}.{name}\n")
    if inspect.isclass(value):
        return _rst(f".. autoclass:: {module}.{name}\n   :members:\n")
    if callable(value):
        return _rst(f".. autofunction:: {module}.{name}\n")
    return _rst(f".. autodata:: {module}.{name}\n")


def _returned(values: dict[str, Any]) -> Iterator[type]:
    """Classes of doseki that exported functions return, and what their public parts return."""
    seen = {value for value in values.values() if inspect.isclass(value)}
    ahead = [part for value in values.values() for part in (value, *_public_parts(value))]
    while ahead:
        for kind in _classes_returned(ahead.pop(0)):
            if kind not in seen:
                seen.add(kind)
                yield kind
                ahead += _public_parts(kind)


def _public_parts(value: Any) -> list[Any]:
    """What a class has, by itself or from other classes of doseki."""
    kinds = [
        kind for kind in getattr(value, "__mro__", ()) if kind.__module__.startswith("doseki.")
    ]
    members = [each for kind in kinds for each in vars(kind).items()]
    return [part for name, part in members if name[0] != "_" or name == "__getitem__"]


def _classes_returned(member: Any) -> Iterator[type]:
    function = getattr(member, "fget", None) or getattr(member, "func", None) or member
    annotations = getattr(function, "__annotations__", {})
    module = getattr(function, "__module__", None)
    if module is None:
        return
    for word in re.findall(r"\w+", str(annotations.get("return", ""))):
        found = getattr(import_module(module), word, None)
        if inspect.isclass(found) and found.__module__.startswith("doseki."):
            yield found
