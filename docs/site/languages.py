"""Colours for code that does not say its language: older pages indent it and name none."""

from __future__ import annotations

import re
import tomllib

from docutils import nodes
from sphinx.application import Sphinx

COMMAND = re.compile(r"^\s*(\./)?doseki ", re.MULTILINE)
PYTHON = re.compile(r"^(import|from) \w|^\w+ = doseki\.", re.MULTILINE)


def language_of(text: str) -> str:
    """The language of a block of code: toml, python, console or none."""
    if PYTHON.search(text):
        return "python"
    if COMMAND.search(text):
        return "sh"
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return "none"
    return "toml" if "=" in text else "none"


def _name_languages(app: Sphinx, document: nodes.document) -> None:
    for block in document.findall(nodes.literal_block):
        given = block.get("language", "none")
        if given == "console":  # lines are commands, without a prompt
            block["language"] = "sh"
        elif given in ("none", "default") and not block.get("classes", []):
            block["language"] = language_of(block.astext())


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("doctree-read", _name_languages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
