"""Equation numbers in the text of all pages become links to the equations."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

from .mathml import TAG, anchor

PAGE = "equations"
NUMBER = r"\(?\d+[a-d]?\)?"
CITED = re.compile(rf"\b[Ee]qs?\.\s*{NUMBER}(?:(?:,\s*(?:and\s+)?|\s+(?:and|to)\s+|-){NUMBER})*")
SINGLE = re.compile(r"\d+[a-d]?")


class EquationLinks(SphinxPostTransform):
    """Eq. (30), Eqs. (42) to (53), eqs. 9 and 11: each number that there is becomes a link."""

    default_priority = 400
    formats = ("html",)

    def run(self, **kwargs: Any) -> None:
        """Replace the texts of the page."""
        known = set(getattr(self.env, "doseki_equations", ()))
        for text in list(self.document.findall(nodes.Text)):
            if CITED.search(text) and not _inside(text):
                text.parent.replace(text, list(self._pieces(str(text), known)))

    def _pieces(self, text: str, known: set[str]) -> Iterator[nodes.Node]:
        target = self.app.builder.get_relative_uri(self.env.current_document.docname, PAGE)
        end = 0
        for cited in CITED.finditer(text):
            for number in SINGLE.finditer(text, cited.start(), cited.end()):
                if number[0] in known:
                    yield nodes.Text(text[end : number.start()])
                    uri = f"{target}#{anchor(number[0])}"
                    yield nodes.reference("", number[0], internal=True, refuri=uri)
                    end = number.end()
        yield nodes.Text(text[end:])


def _inside(text: nodes.Text) -> bool:
    """Whether a text is in a link, in code or in a heading."""
    parent = text.parent
    while parent is not None:
        if isinstance(parent, nodes.reference | nodes.literal | nodes.literal_block | nodes.title):
            return True
        parent = parent.parent
    return False


def _collect(app: Sphinx, document: nodes.document) -> None:
    """Remember which equations there are, for texts and for links to equations.md#eq-30."""
    if app.env.current_document.docname != PAGE:
        return
    found = {}
    for node in document.findall(nodes.math_block):
        if tag := TAG.search(node.astext()):
            name = anchor(tag[1])
            found[name] = (node.line or 0, name, f"({tag[1]})")
    slugs = app.env.metadata[PAGE].setdefault("myst_slugs", {})
    app.env.metadata[PAGE]["myst_slugs"] = {**slugs, **found}
    app.env.doseki_equations = sorted(name.partition("-")[2] for name in found)  # type: ignore[attr-defined]


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("doctree-read", _collect)
    app.add_post_transform(EquationLinks)
    return {"parallel_read_safe": False, "parallel_write_safe": True}
