"""Every link inside the project leads to a file that is there, and to a heading that it has.

The site checks links of its own pages when it is built (test_site.py); this one looks at all
Markdown, as a clone shows it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

import pytest

from .markdown import ROOT, links_of, markdown_files, slugs_of

GENERATED = ("docs/reference/", "docs/decisions/index.md")  # made when the site is built
EQUATION = re.compile(r"eq-\d+[a-d]?")


def broken_links(path: Path, root: Path = ROOT) -> Iterator[str]:
    """The links of a page that lead nowhere."""
    text = path.read_text(encoding="utf-8")
    for link in links_of(text):
        if "://" in link or link.startswith("mailto:"):
            continue
        target, _, anchor = unquote(link).partition("#")
        there = (path.parent / target).resolve() if target else path
        if there.is_relative_to(root) and there.relative_to(root).as_posix().startswith(GENERATED):
            continue
        if not there.exists():
            yield f"{path.name}: {link}: no such file"
        elif anchor and there.suffix == ".md" and not has_anchor(there, anchor):
            yield f"{path.name}: {link}: no such heading"


def has_anchor(page: Path, anchor: str) -> bool:
    """Whether a page has a heading, or an equation, of this name."""
    found = EQUATION.fullmatch(anchor) or anchor in slugs_of(page.read_text(encoding="utf-8"))
    return bool(found)


@pytest.mark.parametrize(
    "path", markdown_files(), ids=lambda path: path.relative_to(ROOT).as_posix()
)
def test_links_lead_somewhere(path):
    assert list(broken_links(path)) == []


def test_broken_links_are_found(tmp_path):
    (tmp_path / "there.md").write_text("# A heading (with signs)\n## Twice\n## Twice\n")
    page = tmp_path / "page.md"
    page.write_text(
        "[a](there.md#a-heading-with-signs) [b](there.md#twice-1) [c](#own)\n\n# Own\n\n"
        "[d](gone.md) ![e](gone.png) [f](there.md#gone)\n"
    )
    assert list(broken_links(page, tmp_path)) == [
        "page.md: gone.md: no such file",
        "page.md: gone.png: no such file",
        "page.md: there.md#gone: no such heading",
    ]
