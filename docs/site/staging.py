"""The folder that Sphinx reads: pages of docs, of the project's top, and generated ones."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from .generated.commands import command_pages
from .generated.decisions import decision_pages
from .generated.equations import equation_pages
from .generated.fields import field_pages
from .generated.keys import key_pages
from .generated.python_api import api_pages
from .menu import toctrees

TOP_PAGES = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
OWN_FOLDER = "site"  # in docs: these modules
LINK = re.compile(r"(\]\()([^)\s#]+)(#[^)\s]*)?(\))")


def pages_of(root: Path) -> dict[str, Path]:
    """The hand-written pages by their place in the site (paths with .md)."""
    docs = root / "docs"
    written = {
        path.relative_to(docs).as_posix(): path
        for path in sorted(docs.rglob("*.md"))
        if path.relative_to(docs).parts[0] != OWN_FOLDER
    }
    return written | {place: root / name for name, place in TOP_PAGES.items()}


def generated_pages(root: Path) -> dict[str, str]:
    """The text of each page that is made from the code, by its place in the site."""
    pages = (
        *key_pages(), *command_pages(), *field_pages(), *api_pages(), *equation_pages(root),
        *decision_pages(root),
    )  # fmt: skip
    return dict(pages)


def stage(root: Path, target: Path) -> None:
    """Write all pages and pictures into `target`; files that did not change are not touched.

    So Sphinx reads again only what is new.
    """
    pages, made = pages_of(root), generated_pages(root)
    texts = {
        place: _relinked(path.read_text(encoding="utf-8"), path, place, root)
        for path, place in ((path, place) for place, path in pages.items())
    } | made
    names = [place.removesuffix(".md") for place in texts]
    texts["index.md"] += "\n" + toctrees(names) + "\n"
    kept = {target / place for place in texts}
    for place, text in texts.items():
        _write(target / place, text.encode())
    for picture in _attachments(root / "docs"):
        kept.add(target / picture.relative_to(root / "docs"))
        _write(target / picture.relative_to(root / "docs"), picture.read_bytes())
    for path in list(target.rglob("*")):
        if path.is_file() and path not in kept:
            path.unlink()


def _attachments(docs: Path) -> Iterator[Path]:
    """What pages show or offer beside text."""
    for path in sorted(docs.rglob("*")):
        inside = path.relative_to(docs)
        if path.is_file() and path.suffix != ".md" and inside.parts[0] != OWN_FOLDER:
            yield path


def _write(path: Path, contents: bytes) -> None:
    if path.is_file() and path.read_bytes() == contents:
        return
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(contents)


def _relinked(text: str, path: Path, place: str, root: Path) -> str:
    """The text with links from where the page lies in the project to where it is in the site.

    What the site has no page for (a folder, a file of code) is named, and not linked.
    """

    def moved(match: re.Match[str]) -> str:
        target, anchor = match[2], match[3] or ""
        if "://" in target or target.startswith("mailto:"):
            return match[0]
        there = (path.parent / target).resolve()
        if there in found:
            return (
                f"{match[1]}{os.path.relpath(found[there], Path(place).parent)}{anchor}{match[4]}"
            )
        return match[0]

    found = {file.resolve(): name for name, file in pages_of(root).items()}
    found |= {(root / "docs" / folder).resolve(): f"{folder}/index.md" for folder in ("decisions",)}
    docs = (root / "docs").resolve()
    found |= {p.resolve(): p.resolve().relative_to(docs).as_posix() for p in _attachments(docs)}
    return UNREACHED.sub(lambda m: _named(m, path, root, found), LINK.sub(moved, text))


UNREACHED = re.compile(r"(?<!!)\[([^\]]+)\]\(([^)\s#]+)\)")


def _named(match: re.Match[str], path: Path, root: Path, found: dict[Path, str]) -> str:
    """A link to a file of the project that is no page: its words and its path."""
    words, target = match.groups()
    there = (path.parent / target).resolve()
    inside = root.resolve() in there.parents and (root / "docs").resolve() not in there.parents
    if "://" in target or not inside or there in found or not there.exists():
        return match[0]
    shown = there.relative_to(root.resolve()).as_posix()
    return f"`{shown}`" if words.strip("`") == shown else f"{words} (`{shown}`)"
