"""The reference of scenario keys: one page for each table, from the declarations of the reader."""

from __future__ import annotations

import re
from collections.abc import Iterator
from inspect import get_annotations
from typing import Any

import numpy as np
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from doseki.scenario.kinematics import ELASTIC, FIXED, PARTICLES, RIGID
from doseki.scenario.materials import MATERIAL_PARAMETERS
from doseki.scenario.schemes import RESOLVED_DEFAULTS, RESOLVED_ETA
from doseki.scenario.table import Kinds, Only, Table
from doseki.scenario.tables.body import BodyTable
from doseki.scenario.tables.root import ScenarioTable
from doseki.scenario.tables.sections import SECTIONS, SINGLE_TABLES
from doseki.scenario.tables.wall import FRICTION_OF

from .key_types import Meaning, meaning_of
from .kinds import where_alone
from .markup import code, prose, sentence, table

HEADER = ("Key", "Value", "Unit", "Default", "Obeyed by", "Meaning")
FOLDER = "reference/keys"
PARAMETERS = {parameter.name: parameter for parameter in MATERIAL_PARAMETERS}
WAYS = {"rigid": RIGID, "elastic": ELASTIC, "fixed": FIXED, "particles": PARTICLES}
TITLES = {  # of tables that need more than their docstring
    "top": ("Top level of a scenario", "Keys that stand before the first `[table]` of the file."),
}

Page = tuple[str, str]


def key_pages() -> Iterator[Page]:
    """A page for each table of a scenario, and the one that lists them."""
    names = {"top": ScenarioTable, **SINGLE_TABLES, **SECTIONS}
    for name, kind in names.items():
        yield f"{FOLDER}/{name}.md", _page(name, kind)
    yield f"{FOLDER}/index.md", _index(names)


def _index(names: dict[str, Any]) -> str:
    rows = []
    for name, kind in names.items():
        about = kind.common if isinstance(kind, Kinds) else kind
        words = sentence(_first_sentence(about)) if name != "top" else TITLES["top"][1]
        rows.append((f"[{_title(name)}]({name}.md)", prose(words)))
    rows = [(link, words.replace("\\`", "`")) for link, words in rows]
    tree = "\n".join(["```{toctree}", ":hidden:", "", *names, "```"])
    return f"{INTRODUCTION}\n{table(('Table', 'What it is'), rows)}\n{tree}\n"


INTRODUCTION = """\
# Every key of a scenario

These pages are made from the declarations by which doseki reads a scenario file, so they list every key that there is and no
other. For an introduction with examples read [Scenarios](../../scenarios.md) first.

- **Unit** is that of a plain number. A string may name another one: `dp = "2.5 mm"` ([units](../../scenarios.md#units)).
- **Default** is what a key has when it is left out; *required* keys must be given.
- **Obeyed by** says where a key means something: in which scheme, dimension or kind of body. Elsewhere it is refused, never
  ignored. *All* means every run that can have the table.
- *Expression* means that a string such as `"= 2*dp"` or, for fields, `"= 0.1*sin(x)"` may stand there. Numbers of any key may be
  expressions of your own [parameters](parameters.md).
"""


def _title(name: str) -> str:
    if name == "top":
        return TITLES["top"][0]
    return f"\\[{name}\\]" if name in SINGLE_TABLES else f"\\[{name}.NAME\\]"


def _page(name: str, kind: type[Table] | Kinds) -> str:
    title = f"# {_title(name)}"
    if name == "top":
        return f"{title}\n\n{TITLES['top'][1]}\n\n{_keys_table(name, kind, _root_fields())}"
    if not isinstance(kind, Kinds):
        return f"{title}\n\n{_described(kind)}\n\n{_keys_table(name, kind, kind.model_fields)}{_inner(name, kind)}"
    return f"{title}\n\n{_of_kinds(name, kind)}"


def _root_fields() -> dict[str, FieldInfo]:
    tables = {*SECTIONS, *SINGLE_TABLES}
    return {key: info for key, info in ScenarioTable.model_fields.items() if key not in tables}


def _of_kinds(section: str, kinds: Kinds) -> str:
    """A section for each kind with the keys of its own, then those that several kinds share."""
    by_class: dict[type[Table], list[str]] = {}
    for word, kind in kinds.tables.items():
        by_class.setdefault(kind, []).append(word)
    shared: dict[type[Table], None] = {}
    parts = [f"The key `{kinds.key}` says which kind a table is of."]
    for kind, words in by_class.items():
        heading = " or ".join(f'`{kinds.key} = "{word}"`' for word in words)
        if words == ["grains"]:
            heading = "Packed grains: `shape` with `d` or `grading`"
        common = [base for base in _ancestors(kind) if _own(base)]
        shared |= dict.fromkeys(common)
        text = [f"## {heading}", _described(kind), where_alone(section, kind)]
        text.append(_keys_table(section, kind, _own(kind)))
        links = [f"[{_shared_title(base)}](#{_slug(section, base)})" for base in common]
        text.append(f"It also has: {', '.join(links)}." if links else "")
        parts.append("\n\n".join(t for t in text if t))
    parts += [_shared_section(section, base) for base in shared]
    inner = {k: None for kind in (*by_class, *shared) for k in _tables_in(kind)}
    parts += [_inner_table(section, key, held) for key, held in inner]
    return "\n\n".join(parts) + "\n"


def _shared_section(section: str, base: type[Table]) -> str:
    title = _shared_title(base)
    heading = f"({_slug(section, base)})=\n## {title[0].upper()}{title[1:]}"
    return f"{heading}\n\n{_described(base)}\n\n{_keys_table(section, base, _own(base))}"


def _ancestors(kind: type[Table]) -> list[type[Table]]:
    return [b for b in kind.__mro__[1:] if issubclass(b, Table) and b is not Table]


def _own(kind: type[Table]) -> dict[str, FieldInfo]:
    """The keys that a class declares itself."""
    declared = get_annotations(kind)
    return {key: info for key, info in kind.model_fields.items() if key in declared}


SHARED_TITLES = {
    "Part": "the switch of every table", "BodyTable": "keys of every body",
    "ShapedBody": "keys of every body with a shape", "WallKeys": "keys of walls",
    "TurnedBody": "keys of bodies that can be turned",
    "LatticeBody": "keys of bodies on a lattice", "Gauge": "keys of every gauge",
    "FlowGauge": "keys of gauges that look at a place", "Metered": "keys of meters of fixed bodies",
    "Figure": "keys of every figure", "FigureOfSnapshots": "keys of figures of snapshots",
}  # fmt: skip


def _shared_title(base: type[Table]) -> str:
    return SHARED_TITLES.get(base.__name__, f"keys of {base.__name__}")


def _slug(section: str, base: type[Table]) -> str:
    return f"{section}-{base.__name__.lower()}"


def _inner(section: str, kind: type[Table]) -> str:
    found = dict.fromkeys(_tables_in(kind))
    return "".join(f"\n\n{_inner_table(section, key, held)}" for key, held in found)


def _tables_in(kind: type[Table]) -> Iterator[tuple[str, type[Table]]]:
    for key, info in kind.model_fields.items():
        held = meaning_of(info).inner
        if held is not None:
            yield key, held


def _inner_table(section: str, key: str, held: type[Table]) -> str:
    rows = _keys_table(f"{section}-{key}", held, held.model_fields)
    return f"## The table `{key}`\n\n{_described(held)}\n\n{rows}"


def _described(kind: type[Table]) -> str:
    if kind.__name__ == "MaterialTable":
        return "The parameters of a material. A built-in one needs only what differs from it."
    return prose(" ".join((kind.__doc__ or "").split()))


def _first_sentence(kind: type[Table]) -> str:
    words = {"BodyTable": "A body", "ShapedBody": "What there is at the start: fluid, grains, walls",
             "MaterialTable": "The parameters of a material",
             "Gauge": "An instrument that is read at times of its own",
             "Figure": "A picture made from the record of a run"}  # fmt: skip
    return words.get(kind.__name__) or (kind.__doc__ or "").partition(".")[0]


def _keys_table(section: str, kind: Any, fields: dict[str, FieldInfo]) -> str:
    if not fields:
        return ""
    rows = [_row(section, kind, key, info) for key, info in fields.items()]
    return table(HEADER, rows, "keys scenario-keys")


def _row(section: str, kind: type[Table], key: str, info: FieldInfo) -> tuple[str, ...]:
    about = meaning_of(info)
    name = info.alias or key
    limits = f"; {' and '.join(about.limits)}" if about.limits else ""
    meaning = "which kind it is" if key in ("shape", "kind") else _said(info, about)
    return (
        f"`{name}`",
        prose(about.words + limits),
        unit_of(key, about, info),
        default_of(kind, key, info),
        obeyed_by(kind, key, about),
        sentence(prose(meaning)),
    )


def _said(info: FieldInfo, about: Meaning) -> str:
    """The description, without what stands in columns of its own: unit and scheme."""
    text = info.description or _inner_words(about)
    only = about.only or Only()
    for told in (only.scheme, f"{only.dim}-D"):
        text = text.removeprefix(f"{told}: ")
    for unit in about.units:
        text = re.sub(rf", {re.escape(unit)}(?=$|;| \()", "", text)
        text = re.sub(rf"^{re.escape(unit)} (?=\w)", "", text)
        text = "" if text == unit else text.removeprefix(f"{unit}, ").removeprefix(f"{unit}; ")
    return text


def _inner_words(about: Meaning) -> str:
    return (about.inner.__doc__ or "").partition("\n")[0] if about.inner else ""


def unit_of(key: str, about: Meaning, info: FieldInfo) -> str:
    """The unit of a plain number; empty where there is none."""
    if not about.units and key in PARAMETERS and about.words == "number":
        return PARAMETERS[key].unit
    return "; ".join(dict.fromkeys(about.units))


def default_of(kind: type[Table], key: str, info: FieldInfo) -> str:
    """What the key has where it is not given."""
    if info.is_required():
        return "*required*"
    value = info.get_default(call_default_factory=True)
    if kind is ScenarioTable and key == "eta":
        return f"{_shown(value)}; resolved: {_shown(RESOLVED_ETA['wendland_c2'])}"
    if kind is ScenarioTable and key in RESOLVED_DEFAULTS:
        return f"{_shown(value)}; resolved: {_shown(RESOLVED_DEFAULTS[key])}"
    if value is None or value is PydanticUndefined:
        return ""
    return _shown(value)


def _shown(value: Any) -> str:
    if isinstance(value, Table):
        return ""
    if isinstance(value, bool):
        return code(str(value).lower())
    if isinstance(value, str):
        return code(f'"{value}"')
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return code("[]" if value in ([], {}) else str(value))


def obeyed_by(kind: type[Table], key: str, about: Meaning) -> str:
    """Where the key means something, as the checks of a scenario have it."""
    parts = _of_only(about.only) if about.only else []
    if key in FRICTION_OF and issubclass(kind, Table) and "wall" in kind.model_fields:
        parts.append(f'`wall = "{FRICTION_OF[key]}"`')
    if issubclass(kind, BodyTable):
        parts += _of_motion(key)
    parameter = PARAMETERS.get(key)
    if kind.__name__ == "MaterialTable" and parameter is not None and parameter.law:
        parts.append(f"{parameter.law}s")
    return ", ".join(parts) or "all"


def _of_only(only: Only) -> list[str]:
    parts = [only.scheme] if only.scheme else []
    if only.dim:
        parts.append(f"{only.dim}-D")
    if only.fixed is not None:
        parts.append("fixed bodies" if only.fixed else "bodies that are not fixed")
    return parts


def _of_motion(key: str) -> list[str]:
    """The ways for a body to move that give the key a meaning, where not all do."""
    ways = [name for name, way in WAYS.items() if way.why_not(key) is None]
    if len(ways) == len(WAYS):
        return []
    return ["resolved", " and ".join(ways) + " bodies"]
