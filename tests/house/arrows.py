"""Reads which files of a tree import which, and finds arrows that run back and circles."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path, PurePosixPath

Arrow = tuple[PurePosixPath, PurePosixPath]  # a file, and one that it imports; within the tree
Order = list[set[str]]  # top folders and files by name, first those that import nothing

CPP_SUFFIXES = {".hpp", ".cpp", ".cu", ".cuh", ".inl", ".ipp"}
SOURCE_SUFFIXES = CPP_SUFFIXES | {".py", ".pyi"}


def sources(tree: Path, suffixes: Iterable[str] = SOURCE_SUFFIXES) -> list[Path]:
    """Source files of a tree, sorted."""
    found = (path for path in tree.rglob("*") if path.suffix in set(suffixes))
    return sorted(path for path in found if "__pycache__" not in path.parts)


def read_order(text: str, tree: str) -> Order:
    """The row of a table that begins with the cell `tree`: names, those in braces side by side."""
    row = next(line for line in text.splitlines() if line.strip().startswith(f"| `{tree}` |"))
    names = row.strip().strip("|").split("|")[1]
    groups = re.findall(r"\{[^}]*\}|[\w.]+", names)
    return [set(re.findall(r"[\w.]+", group)) for group in groups]


def python_arrows(package: Path) -> Iterator[Arrow]:
    """Imports among the modules of a package, those inside functions and TYPE_CHECKING included.

    Those under TYPE_CHECKING of the package's own __init__ are left out: they say which names it
    gives, and import nothing.
    """
    for file in sources(package, {".py", ".pyi"}):
        here = PurePosixPath(file.relative_to(package))
        tree = ast.parse(file.read_text(encoding="utf-8"))
        given = _given_names(tree) if here == PurePosixPath("__init__.py") else set()
        for node in ast.walk(tree):
            if node in given:
                continue
            for target in _imported(package, here, node):
                if target != here:
                    yield here, target


def _given_names(tree: ast.Module) -> set[ast.AST]:
    """What stands under TYPE_CHECKING at the top of a module."""
    guards = (node for node in tree.body if isinstance(node, ast.If))
    checked = (node for node in guards if ast.unparse(node.test) == "TYPE_CHECKING")
    return {inner for node in checked for part in node.body for inner in ast.walk(part)}


def _imported(package: Path, here: PurePosixPath, node: ast.AST) -> Iterator[PurePosixPath]:
    """The files of the package that one statement imports."""
    if isinstance(node, ast.Import):
        for alias in node.names:
            if target := _absolute(package, alias.name):
                yield target
    elif isinstance(node, ast.ImportFrom):
        if node.level:
            base = here.parents[node.level - 1] if node.level <= len(here.parents) else None
            assert base is not None, f"{here}:{node.lineno} imports from outside of the package"
            base = base.joinpath(*(node.module or "").split("."))
        elif (node.module or "").split(".")[0] == package.name:
            base = PurePosixPath(*(node.module or "").split(".")[1:])
        else:
            return
        for alias in node.names:
            yield _module(package, base / alias.name) or _module_or_fail(package, here, base)


def _absolute(package: Path, name: str) -> PurePosixPath | None:
    first, *rest = name.split(".")
    return _module(package, PurePosixPath(*rest)) if first == package.name else None


def _module(package: Path, name: PurePosixPath) -> PurePosixPath | None:
    """The file of a module or package."""
    for file in (name / "__init__.py", name.with_suffix(".py") if name.name else None):
        if file and (package / file).is_file():
            return file
    return None


def _module_or_fail(package: Path, here: PurePosixPath, name: PurePosixPath) -> PurePosixPath:
    found = _module(package, name)
    assert found, f"{here} imports {name}, which is not there"
    return found


def cpp_arrows(tree: Path) -> Iterator[Arrow]:
    """Includes among the files of a tree, by their place in it or beside the file."""
    for file in sources(tree, CPP_SUFFIXES):
        here = PurePosixPath(file.relative_to(tree))
        text = file.read_text(encoding="utf-8")
        for name in re.findall(r'^\s*#\s*include\s*"([^"]+)"', text, re.MULTILINE):
            places = (file.parent / name, tree / name)
            found = next((place.resolve() for place in places if place.is_file()), None)
            if found and found.is_relative_to(tree.resolve()):
                yield here, PurePosixPath(found.relative_to(tree.resolve()))


def back_arrows(arrows: Iterable[Arrow], order: Order) -> list[str]:
    """Arrows between top folders that do not run to one before, and folders without a place."""
    place = {name: k for k, group in enumerate(order) for name in group}
    found = []
    for source, target in sorted(set(arrows)):
        a, b = _top(source), _top(target)
        found += [f"{name} has no place in the order" for name in (a, b) if name not in place]
        if a != b and a in place and b in place and place[b] >= place[a]:
            found.append(f"{source} -> {target}: {a} may not import {b}")
    return list(dict.fromkeys(found))


def _top(path: PurePosixPath) -> str:
    return path.parts[0].removesuffix(".py")


def circles(arrows: Iterable[Arrow]) -> list[str]:
    """Circles among the files and folders of each folder, the shortest of each knot arrow by arrow.

    What is inside a folder counts as the folder, so that two folders whose files import one another
    are a circle even where no two files are.
    """
    arrows = sorted(set(arrows))
    found = []
    for folder in sorted({parent for arrow in arrows for file in arrow for parent in file.parents}):
        found += _circles_in(folder, arrows)
    return found


def _circles_in(folder: PurePosixPath, arrows: list[Arrow]) -> Iterator[str]:
    """Circles among the children of one folder."""
    made_by: dict[tuple[str, str], Arrow] = {}
    graph: dict[str, set[str]] = {}
    for source, target in arrows:
        if source.is_relative_to(folder) and target.is_relative_to(folder):
            depth = len(folder.parts)
            a, b = source.parts[depth], target.parts[depth]
            if a != b:
                made_by.setdefault((a, b), (source, target))
                graph.setdefault(a, set()).add(b)
    for knot in _knots(graph):
        way = _shortest_circle(graph, knot)
        said = [f"{s} -> {t}" for s, t in (made_by[step] for step in pairwise(way))]
        yield f"{folder}: {', '.join(sorted(knot))} import each other: {'; '.join(said)}"


def _knots(graph: dict[str, set[str]]) -> list[set[str]]:
    """Sets of more than one node that reach each other."""
    reach = {node: _reachable(graph, node) for node in graph}
    knots = [frozenset({a, *(b for b in reach[a] if a in reach.get(b, ()))}) for a in sorted(reach)]
    return [set(knot) for knot in dict.fromkeys(knots) if len(knot) > 1]


def _shortest_circle(graph: dict[str, set[str]], knot: set[str]) -> list[str]:
    """Nodes of a knot from one back to it, each importing the next."""
    ways = [[node] for node in sorted(knot)]
    while True:
        ways = [[*way, node] for way in ways for node in sorted(graph[way[-1]] & knot)]
        for way in ways:
            if way[-1] == way[0]:
                return way
        ways = [way for way in ways if len(set(way)) == len(way)]


def _reachable(graph: dict[str, set[str]], start: str) -> set[str]:
    seen: set[str] = set()
    todo = [start]
    while todo:
        for node in graph.get(todo.pop(), ()):
            if node not in seen:
                seen.add(node)
                todo.append(node)
    return seen
