"""HTML from Python: every text is escaped, but for what is Markup already."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape

UNKNOWN = "-"  # of what has no number
VOID = {"img", "input", "meta", "br"}


class Markup(str):
    """Text that is HTML."""

    __slots__ = ()


Content = str | Markup | None | Iterable["Content"]


def markup(content: Content) -> Markup:
    """Content as HTML: strings are escaped, None is nothing, others are put in a row."""
    if content is None:
        return Markup("")
    if isinstance(content, Markup):
        return content
    if isinstance(content, str):
        return Markup(escape(_printable(content)))
    return Markup("".join(markup(each) for each in content))


def _printable(text: str) -> str:
    """Without control characters, which a page may not hold, and halves of characters."""
    kept = "".join(c if c >= " " or c in "\n\t" else "\ufffd" for c in text)
    return kept.encode("utf-8", "replace").decode("utf-8")


def tag(name: str, /, *content: Content, **attributes: str | bool | None) -> Markup:
    """An element; the attribute `class_` is "class", `data_x` "data-x", True is one alone."""
    given = ""
    for key, value in attributes.items():
        if value is None or value is False:
            continue
        word = key.rstrip("_").replace("_", "-")
        given += f" {word}" if value is True else f' {word}="{markup(value)}"'
    if name in VOID:
        return Markup(f"<{name}{given}>")
    return Markup(f"<{name}{given}>{markup(content)}</{name}>")


def table(head: Sequence[Content], rows: Iterable[Sequence[Content]], caption: str = "") -> Markup:
    """A table that scrolls sideways where it is wide; columns of numbers go right."""
    body = [list(row) for row in rows]
    width = max(map(len, [head, *body]))
    classes = ["number" if _is_of_numbers(body, column) else None for column in range(width)]
    lines = [tag("tr", map(_cell, row, classes)) for row in body]
    heads = tag("thead", tag("tr", map(_head, head, classes)))
    title = tag("caption", caption) if caption else None
    return tag("div", tag("table", title, heads if head else None, tag("tbody", lines)),
               class_="scroll")  # fmt: skip


def _is_of_numbers(rows: Sequence[Sequence[Content]], column: int) -> bool:
    """Whether a column has numbers, and nothing else but cells without one."""
    cells = [row[column] for row in rows if column < len(row)]
    known = [cell for cell in cells if cell not in ("", UNKNOWN)]
    return bool(known) and all(map(_is_number, known))


def _head(cell: Content, kind: str | None) -> Markup:
    return tag("th", cell, scope="col", class_=kind)


def _cell(cell: Content, kind: str | None) -> Markup:
    return tag("td", cell, class_=kind)


def _is_number(cell: Content) -> bool:
    if not isinstance(cell, str) or isinstance(cell, Markup):
        return False
    try:
        float(cell.replace(",", ""))
    except ValueError:
        return False
    return True


def terms(rows: Mapping[str, Content] | Iterable[tuple[str, Content]]) -> Markup:
    """Names and what they mean; a row with an empty name goes on with the one before."""
    pairs = rows.items() if isinstance(rows, Mapping) else rows
    return tag("dl", [[tag("dt", name) if name else None, tag("dd", text)] for name, text in pairs])


def section(title: str, *content: Content, name: str = "") -> Markup | None:
    """A section with a heading; None without any content."""
    inside = markup(content)
    return tag("section", tag("h2", title), inside, id=name or None) if inside else None
