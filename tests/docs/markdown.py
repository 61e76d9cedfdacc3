"""The Markdown of the project, as tests look at it: blocks of code, links, headings, prose."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.dollarmath import dollarmath_plugin

ROOT = Path(__file__).resolve().parents[2]
_parser = MarkdownIt("commonmark").enable("table").use(dollarmath_plugin, double_inline=True)


@dataclass(frozen=True)
class Block:
    """A fenced block of code: its language, text and first line."""

    language: str
    text: str
    line: int


def markdown_files() -> list[Path]:
    """Every Markdown file of the project."""
    folders = ("docs", "validation", "bench", "scenarios", "tests")
    files = [*ROOT.glob("*.md"), *(p for name in folders for p in (ROOT / name).rglob("*.md"))]
    return sorted(files)


def tokens_of(text: str) -> list[Token]:
    """The tokens of a page."""
    return _parser.parse(text)


def blocks_of(text: str) -> list[Block]:
    """The fenced blocks of code of a page, in order."""
    return [
        Block(token.info.strip(), token.content, (token.map or [0])[0] + 1)
        for token in tokens_of(text)
        if token.type == "fence"
    ]


def links_of(text: str) -> Iterator[str]:
    """The targets of links and pictures."""
    for token in tokens_of(text):
        for child in token.children or ():
            if child.type == "link_open":
                yield str(child.attrs["href"])
            elif child.type == "image":
                yield str(child.attrs["src"])


def slugs_of(text: str) -> set[str]:
    """The anchors of the headings of a page, as GitHub and the site make them."""
    found: set[str] = set()
    tokens = tokens_of(text)
    for opening, inside in pairwise(tokens):
        if opening.type == "heading_open":
            words = "".join(c.content for c in inside.children or () if c.type != "softbreak")
            slug = re.sub(r"[^\w\- ]", "", words.strip().lower()).replace(" ", "-")
            while slug in found:  # a second heading of the same words
                head, _, count = slug.rpartition("-")
                slug = (
                    f"{head}-{int(count) + 1}" if count.isdigit() and head in found else f"{slug}-1"
                )
            found.add(slug)
    return found


def prose_of(text: str) -> Iterator[str]:
    """The words of a page: no code, formulas or addresses."""
    for token in tokens_of(text):
        for child in token.children or ():
            if child.type in ("text", "image"):
                yield child.content
