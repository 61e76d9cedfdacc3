"""What STL files say of themselves, looked at before trimesh reads them."""

from __future__ import annotations

from pathlib import Path

from ...errors import UserError
from .mesh_lines import check_stl

BEFORE, TRIANGLE = 84, 50  # bytes of a binary file: its header and count, and each triangle


def readable_stl(file: Path, content: bytes) -> bytes:
    """An STL file as trimesh can read it; raises UserError where a binary one is not whole, or a
    text has lines without numbers.

    Of a text, names come in any encoding: what is no UTF-8 is replaced.
    """
    if b"\0" not in content:  # both kinds may begin with the word solid
        _check_end(file, content.lower())
        check_stl(file, content)
        return in_utf8(content)
    count = int.from_bytes(content[BEFORE - 4 : BEFORE], "little")
    held = max(len(content) - BEFORE, 0) / TRIANGLE
    if held != count:
        raise UserError(
            f"{file}: {count} triangles are said to follow, it holds {held:.6g}; it is damaged, or "
            "no STL"
        )
    return content


def _check_end(file: Path, text: bytes) -> None:
    """Refuse a text that stops within a solid, of which a reader takes nothing."""
    if text.rfind(b"facet normal") > text.rfind(b"endsolid"):
        raise UserError(
            f"{file}: is cut off: no line `endsolid` ends its last solid; write or copy it again"
        )


def in_utf8(text: bytes) -> bytes:
    """A text with a mark in place of what is no UTF-8."""
    return text.decode("utf-8", "replace").encode()
