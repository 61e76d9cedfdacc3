"""The reference of commands, from the command line itself."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer

from doseki.cli.app import app

from .markup import code, prose, sentence, table


def command_pages() -> Iterator[tuple[str, str]]:
    """The page of commands."""
    group: Any = typer.main.get_command(app)
    context = typer.Context(group, info_name="doseki")
    parts = [INTRODUCTION]
    for name, command in group.commands.items():
        if not command.hidden:
            parts.append(_section(typer.Context(command, parent=context, info_name=name)))
    yield "reference/commands.md", "\n\n".join(parts) + "\n"


INTRODUCTION = """\
# Every command

`doseki COMMAND --help` prints the same in a terminal. In a clone write `./doseki` in place of `doseki`. Commands that read a run take
its folder, `DIR`.

| Exit code | Meaning |
|---|---|
| 0 | done, or stopped on request |
| 1 | a validation case fails |
| 2 | bad input: one sentence says which file, key and value, and what is allowed |
| 3 | the physics went wrong: `doseki explain DIR` says why |
| 4 | out of memory or disk |
| 130 | Ctrl-C before the first step of a run, or in another command |
"""


def _section(context: typer.Context) -> str:
    command = context.command
    arguments = [_metavar(p) for p in command.params if p.param_type_name == "argument"]
    text = [f"## doseki {context.info_name}", _prose(command.help or "")]
    text.append(f"```text\n{' '.join([context.command_path, '[OPTIONS]', *arguments])}\n```")
    rows = [_row(p) for p in command.params if not getattr(p, "hidden", False)]
    if rows:
        text.append(table(("Argument or option", "Default", "Meaning"), rows, "options"))
    return "\n\n".join(text)


def _prose(help_text: str) -> str:
    paragraphs = help_text.replace("\f", "").split("\n\n")
    return "\n\n".join(prose(" ".join(paragraph.split())) for paragraph in paragraphs)


def _row(parameter: Any) -> tuple[str, str, str]:
    names = ", ".join(code(name) for name in (*parameter.opts, *parameter.secondary_opts))
    if parameter.param_type_name == "argument":
        names = code(_metavar(parameter))
    elif not getattr(parameter, "is_flag", False):
        names += f" {code(_metavar(parameter))}"
    return names, _default(parameter), sentence(prose(parameter.help or ""))


def _metavar(parameter: Any) -> str:
    """What stands for the value of an option."""
    return str(parameter.metavar or parameter.name.upper())


def _default(parameter: Any) -> str:
    shown = getattr(parameter, "show_default", None)
    if isinstance(shown, str):
        return prose(shown)
    value = parameter.default
    if parameter.required:
        return "*required*"
    if value is None or callable(value) or value in (False, (), []) or value != value:
        return ""
    if getattr(parameter, "is_flag", False):
        return code(parameter.opts[0])
    if isinstance(value, float) and abs(value) == float("inf"):
        return ""
    return code(str(getattr(value, "value", value)))
