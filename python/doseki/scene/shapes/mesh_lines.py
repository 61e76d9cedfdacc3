"""What is wrong with a line of a file of triangles that is a text, told before it is read.

What reads such files either says nothing of the line or leaves it out.
"""

from __future__ import annotations

import re
from pathlib import Path

from ...errors import UserError

GAP = rb"(?:[ \t]|\\\r?\n)+"  # a line of an OBJ may go on in the next one
NUMBER = rb"[-+]?(?:(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?|nan|inf(?:inity)?)"
INDEX = rb"-?\d+(?:/-?\d*){0,2}"
TAIL = rb"(?:[ \t]*(?:#[^\n]*)?\r?$)"
# Lines that begin as they should and do not go on like that.
BAD_FACE = rb"^f(?=\s)(?!(?:%s%s){3,}%s)" % (GAP, INDEX, TAIL)
BAD_VERTEX = rb"^v(?=[ \t])(?!(?:%s%s){3,}%s)" % (GAP, NUMBER, TAIL)
# Of an STL, the normals of which are not used.
BAD_POINT = rb"^[ \t]*vertex(?=[ \t])(?!(?:[ \t]+%s){3}%s)" % (NUMBER, TAIL)
NO_VERTEX = rb"^f[^\n#]*[ \t]0+(?=[/\s]|$)"

PLY_TYPES = ("char", "uchar", "short", "ushort", "int", "uint", "float", "double")
PLY_SIZED = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")


def check_stl(file: Path, content: bytes) -> None:
    """Raise UserError for the first line of a text STL that cannot be read as it is."""
    if bad := _first(BAD_POINT, content):
        raise UserError(f"{_place(file, content, bad)}: {_no_numbers(bad, NUMBER)}")


def check_obj(file: Path, content: bytes) -> None:
    """The same of an OBJ."""
    if bad := _first(BAD_VERTEX, content):
        raise UserError(f"{_place(file, content, bad)}: {_no_numbers(bad, NUMBER)}")
    if bad := _first(NO_VERTEX, content):
        place = _place(file, content, bad)
        raise UserError(f"{place}: a face names vertex 0; they are counted from 1")
    if bad := _first(BAD_FACE, content):
        raise UserError(f"{_place(file, content, bad)}: {_no_numbers(bad, INDEX)}")


def _first(pattern: bytes, content: bytes) -> re.Match[bytes] | None:
    return re.compile(pattern + rb"[^\n]*", re.MULTILINE | re.IGNORECASE).search(content)


def _place(file: Path, content: bytes, found: re.Match[bytes]) -> str:
    line = content[: found.start()].count(b"\n") + 1
    return f"{file}, line {line}"


def _no_numbers(line: re.Match[bytes], form: bytes) -> str:
    """What is wrong with a line that should have three numbers or more, each of a form."""
    name, *numbers = line[0].decode("utf-8", "replace").partition("#")[0].split()
    what, of = ("a face", "vertices") if name in "fF" else ("a vertex", "numbers")
    for word in numbers:
        if not re.fullmatch(form, word.encode(), re.IGNORECASE):
            points = "; decimal numbers have points" if "," in word else ""
            return f"{what} has {word[:40]!r}, which is not a number{points}"
    more = " or more" if of == "vertices" else ""
    return f"{what} of {len(numbers)} {of}; three{more} are needed"


def check_ply_header(file: Path, header: bytes, size: int) -> None:
    """Raise UserError for a header of a PLY file, of `size` bytes, that names what cannot be."""
    known = (*PLY_TYPES, *PLY_SIZED)
    for number, line in enumerate(header.decode("ascii", "replace").splitlines(), start=1):
        word, *rest = line.split() or [""]
        types = rest[1:3] if rest[:1] == ["list"] else rest[:1]
        wrong = [name for name in types if word == "property" and name not in known]
        if wrong:
            raise UserError(
                f"{file}, line {number}: {wrong[0][:40]!r} is no type of a number; known: "
                f"{', '.join(PLY_TYPES)}"
            )
        if word != "element":
            continue
        name, count = (*rest, "", "")[:2]
        if not (count.isascii() and count.isdigit()):
            raise UserError(
                f"{file}, line {number}: element {name[:40]} has {count[:40]!r}, which is not a "
                "whole number"
            )
        if len(count) > 20 or int(count) > size:
            raise UserError(
                f"{file}, line {number}: {count[:40]} of the element {name[:40]} are more than a "
                f"file of {size} bytes holds; it is cut short or damaged"
            )
