"""Faces of PLY files: of different numbers of corners in binary, which trimesh does not read, and
of fewer than three, which it leaves out without a word.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "float": "f4", "double": "f8", "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2",
    "int32": "i4", "uint32": "u4", "float32": "f4", "float64": "f8",
}  # fmt: skip
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
CORNERS = ("vertex_index", "vertex_indices")  # what programs call those of a face
FEWEST = 3  # corners of a face
READ_ELSEWHERE = ({3}, {4})  # numbers of corners of all faces of a file
Column = np.ndarray | list[np.ndarray]  # a number, or a list of them, of each record
Columns = dict[str, Column]


@dataclass(frozen=True)
class Property:
    """One of the numbers, or the list of numbers, that each record of an element has."""

    name: str
    kind: np.dtype
    counted_by: np.dtype | None = None  # the number before a list that says how long it is


@dataclass(frozen=True)
class Element:
    """Records of one kind, as vertices or faces."""

    name: str
    count: int
    properties: list[Property] = field(default_factory=list)


def mixed_faces(content: bytes) -> tuple[np.ndarray, Column] | None:
    """Vertices (n, 3) and the corners of each face of a binary PLY.

    None for other files, without faces too, and where all are triangles, or all have four corners.
    Raises ValueError where it is damaged.
    """
    lines, data = _header(content)
    order = ORDERS.get(_format(lines))
    if order is None:
        return None
    start = len(content) - len(data) + data.index(b"\n") + 1
    found: dict[str, Columns] = {}
    for element in _elements(lines, order):
        found[element.name], start = _read(content, element, start)
    if start != len(content):
        raise ValueError("the file is longer than its header says")
    faces = _corners(found.get("face", {}))
    if not len(faces) or {len(face) for face in faces} in READ_ELSEWHERE:
        return None
    return np.column_stack([np.asarray(found["vertex"][axis], float) for axis in "xyz"]), faces


def text_corners(content: bytes) -> list[int]:
    """How many corners each face of a text PLY has; none of other files.

    Raises ValueError or IndexError where it is damaged.
    """
    lines, data = _header(content)
    if _format(lines) != "ascii":
        return []
    rows = [row for row in data.splitlines()[1:] if row.strip()]
    start, found = 0, []
    for element in _elements(lines, "<"):
        if element.name == "face":
            found = [_corners_in(row.split(), element) for row in rows[start:][: element.count]]
        start += element.count
    return found


def _corners_in(words: list[bytes], face: Element) -> int:
    """How many corners a line says that its face has."""
    at = 0
    for of in face.properties:
        length = 1 if of.counted_by is None else int(float(words[at]))
        if of.name in CORNERS or len(face.properties) == 1:
            return length
        at += length + (of.counted_by is not None)
    return FEWEST


def _header(content: bytes) -> tuple[list[list[str]], bytes]:
    """The words of each line before the end of the header, and what follows these."""
    head, _, data = content.partition(b"end_header")
    return [line.split() for line in head.decode("ascii", "replace").splitlines()], data


def _format(lines: list[list[str]]) -> str:
    """What the header calls the form of what follows it."""
    return next((words[1] for words in lines if words[:1] == ["format"]), "")


def _elements(lines: list[list[str]], order: str) -> list[Element]:
    """What follows the header, in the order in which it stands there."""
    found: list[Element] = []
    for word, *rest in filter(None, lines):
        if word == "element":
            found.append(Element(rest[0], int(rest[1])))
        elif word == "property":
            kinds = [np.dtype(order + TYPES[name]) for name in rest[:-1] if name != "list"]
            found[-1].properties.append(Property(rest[-1], kinds[-1], *kinds[:-1]))
    return found


def _corners(columns: Columns) -> Column:
    """Of the properties of faces the one that is their corners."""
    lists = [name for name in columns if name in CORNERS or len(columns) == 1]
    return columns[lists[0]] if lists else []


def _read(content: bytes, element: Element, start: int) -> tuple[Columns, int]:
    """The records of an element that begin at a byte, by property, and where they end."""
    if not (element.count and element.properties):
        return {each.name: [] for each in element.properties}, start
    sizes, _ = _one(content, element, start)
    found = _alike(content, element, start, [len(numbers) for numbers in sizes])
    return _one_by_one(content, element, start) if found is None else found


def _alike(
    content: bytes, element: Element, start: int, lengths: list[int]
) -> tuple[Columns, int] | None:
    """The same where lists are as long in all records as in the first; None where they are not."""
    names = [str(k) for k in range(len(lengths))]
    fields: list[tuple[str, np.dtype, tuple[int, ...]]] = []
    for name, of, length in zip(names, element.properties, lengths, strict=True):
        if of.counted_by is not None:
            fields.append((f"count {name}", of.counted_by, ()))
        fields.append((name, of.kind, () if of.counted_by is None else (length,)))
    record = np.dtype(fields)
    end = start + element.count * record.itemsize
    if end > len(content):
        return None
    table = np.frombuffer(content, record, element.count, start)
    for name, of, length in zip(names, element.properties, lengths, strict=True):
        if of.counted_by is not None and (table[f"count {name}"] != length).any():
            return None
    return {of.name: table[k] for k, of in zip(names, element.properties, strict=True)}, end


def _one_by_one(content: bytes, element: Element, start: int) -> tuple[Columns, int]:
    """The same of any records."""
    rows = []
    for _ in range(element.count):
        numbers, start = _one(content, element, start)
        rows.append(numbers)
    columns = zip(*rows, strict=True)
    return {
        of.name: list(each) for of, each in zip(element.properties, columns, strict=True)
    }, start


def _one(content: bytes, element: Element, start: int) -> tuple[list[np.ndarray], int]:
    """The numbers of each property of one record, and where it ends."""
    found = []
    for of in element.properties:
        length = 1
        if of.counted_by is not None:
            length = int(np.frombuffer(content, of.counted_by, 1, start)[0])
            start += of.counted_by.itemsize
        if length < 0:
            raise ValueError("a list is shorter than nothing")
        found.append(np.frombuffer(content, of.kind, length, start))
        start += of.kind.itemsize * length
    return found, start
