r"""Formulas as MathML: browsers draw them without scripts, fonts or a network.

A displayed formula with a \tag{30} has the anchor #eq-30, and its number beside it.
"""

from __future__ import annotations

import html
import re
from functools import cache
from typing import Any

from docutils import nodes
from math_core import LatexToMathML
from sphinx.application import Sphinx

TAG = re.compile(r"\\tag\{([^}]*)\}")
# A combining arrow has no width, so that browsers draw it beside the letter.
COMBINING_ARROW = '<mo stretchy="false">\u20d7</mo>'
ARROW = '<mo stretchy="false" class="vector">\u2192</mo>'
_converter = LatexToMathML(annotation=False)


@cache
def mathml(latex: str, display: bool) -> str:
    """The formula as a MathML element; raises math_core.LatexError where it is not LaTeX."""
    drawn = _converter.convert_with_local_state(latex, displaystyle=display)
    return drawn.replace(COMBINING_ARROW, ARROW)


def anchor(number: str) -> str:
    """The anchor of an equation by its number."""
    return f"eq-{number}"


def inline(translator: Any, node: nodes.math) -> None:
    """A formula in a line of text."""
    translator.body.append(mathml(node.astext(), False))
    raise nodes.SkipNode


def displayed(translator: Any, node: nodes.math_block) -> None:
    """A formula on lines of its own, with its number."""
    latex = node.astext()
    number = TAG.search(latex)
    drawn = mathml(TAG.sub("", latex).strip(), True)
    if number is None:
        translator.body.append(f'<div class="formula">{drawn}</div>\n')
    else:
        name, shown = anchor(number[1]), html.escape(number[1])
        link = f'<a class="number" href="#{name}" title="Link to this equation">({shown})</a>'
        scrolls = f'<div class="scroll">{drawn}</div>'
        translator.body.append(f'<div class="formula numbered" id="{name}">{scrolls}{link}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_html_math_renderer("mathml", (inline, None), (displayed, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
