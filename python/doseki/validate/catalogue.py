"""The cases there are: whatever the modules in the folders of cases/ call CASES."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Sequence

from ..errors import UserError
from ..util.spelling import suggestion
from . import cases
from .case import Case


def all_cases() -> dict[str, Case]:
    """Every case by name, in the order of names."""
    modules = [
        importlib.import_module(module.name)
        for module in pkgutil.walk_packages(cases.__path__, f"{cases.__name__}.")
        if not module.ispkg
    ]
    found = [case for module in modules for case in module.CASES]
    if len({case.name for case in found}) != len(found):
        raise ValueError("two validation cases have the same name")
    return {case.name: case for case in sorted(found, key=lambda case: case.name)}


def chosen_cases(names: Sequence[str]) -> list[Case]:
    """The cases of these names, all without any; raises UserError for a name that is not one."""
    known = all_cases()
    for name in names:
        if name not in known:
            raise UserError(f'no validation case named "{name}"{suggestion(name, known)}')
    return [known[name] for name in dict.fromkeys(names)] if names else list(known.values())
