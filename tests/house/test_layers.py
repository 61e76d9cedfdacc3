"""Packages import only those before them, nothing in a circle; files and folders stay small."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from .arrows import back_arrows, circles, cpp_arrows, python_arrows, read_order, sources

ROOT = Path(__file__).resolve().parents[2]
TREES = {"python/doseki": python_arrows, "core": cpp_arrows}
MAX_LINES = 400  # of a file
MAX_FILES = 15  # of a folder

trees = pytest.mark.parametrize("tree", TREES)


def order_of(tree):
    """The order that CONTRIBUTING.md declares."""
    return read_order((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), tree)


def expect_none(found):
    """Fail with one line for each thing that was found."""
    if found:
        pytest.fail("\n".join(found), pytrace=False)


@trees
def test_packages_import_only_those_before_them(tree):
    found = back_arrows(TREES[tree](ROOT / tree), order_of(tree))
    expect_none(found)


@trees
def test_nothing_imports_in_a_circle(tree):
    found = circles(TREES[tree](ROOT / tree))
    expect_none(found)


@trees
def test_every_package_has_its_place_in_the_order(tree):
    names = {name for group in order_of(tree) for name in group}
    there = {path.relative_to(ROOT / tree).parts[0] for path in sources(ROOT / tree)}
    assert names == {name.removesuffix(".py") for name in there}


@trees
def test_files_are_short(tree):
    lines = {
        path: len(path.read_text(encoding="utf-8").splitlines()) for path in sources(ROOT / tree)
    }
    long = [f"{path.relative_to(ROOT)}: {n} lines" for path, n in lines.items() if n > MAX_LINES]
    expect_none(long)


@trees
def test_folders_hold_few_files(tree):
    count = Counter(path.parent for path in sources(ROOT / tree))
    full = [f"{path.relative_to(ROOT)}: {n} files" for path, n in count.items() if n > MAX_FILES]
    expect_none(full)


def write(tree, files):
    """A small tree of files."""
    for name, text in files.items():
        path = tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


ORDER = read_order("| `doseki` | low, {left, right}, high |", "doseki")
SOUND = {
    "low/__init__.py": "",
    "low/a.py": "import math",
    "left/__init__.py": "",
    "left/b.py": "from ..low.a import thing",
    "right/__init__.py": "",
    "right/c.py": "from ..low import a\nfrom doseki.low.a import thing",
    "high/__init__.py": "",
    "high/d.py": "import doseki.left.b\nfrom ..right.c import thing",
}
BACK = {
    "at the top": {"low/a.py": "from ..high.d import thing"},
    "of a module": {"low/a.py": "from ..high import d"},
    "in full": {"low/a.py": "import doseki.high.d"},
    "in a function": {"low/a.py": "def f():\n    from ..high.d import thing\n"},
    "for types": {"low/a.py": "if TYPE_CHECKING:\n    from ..high.d import thing\n"},
    "between siblings": {"left/b.py": "from ..right.c import thing"},
}


def test_a_sound_package_passes(tmp_path):
    write(tmp_path / "doseki", SOUND)
    arrows = list(python_arrows(tmp_path / "doseki"))
    assert len(set(arrows)) == 4
    assert back_arrows(arrows, ORDER) == []
    assert circles(arrows) == []


def test_the_names_that_the_package_gives_are_no_imports(tmp_path):
    names = "if TYPE_CHECKING:\n    from .high.d import thing\n"
    write(tmp_path / "doseki", SOUND | {"__init__.py": names})
    assert back_arrows(python_arrows(tmp_path / "doseki"), ORDER) == []
    write(tmp_path / "doseki", {"__init__.py": "from .high.d import thing\n"})
    assert back_arrows(python_arrows(tmp_path / "doseki"), ORDER) != []


@pytest.mark.parametrize("files", BACK.values(), ids=BACK)
def test_an_arrow_that_runs_back_is_named(tmp_path, files):
    write(tmp_path / "doseki", SOUND | files)
    (found,) = back_arrows(python_arrows(tmp_path / "doseki"), ORDER)
    (source,) = files
    assert found.startswith(f"{source} -> ")


def test_a_package_without_a_place_is_named(tmp_path):
    write(tmp_path / "doseki", SOUND | {"new/e.py": "from ..low import a"})
    found = back_arrows(python_arrows(tmp_path / "doseki"), ORDER)
    assert found == ["new has no place in the order"]


def test_a_circle_of_modules_is_named(tmp_path):
    files = {"low/a.py": "from .x import f", "low/x.py": "def g():\n    from .a import h\n"}
    write(tmp_path / "doseki", SOUND | files)
    (found,) = circles(python_arrows(tmp_path / "doseki"))
    assert "low/a.py -> low/x.py" in found
    assert "low/x.py -> low/a.py" in found


def test_a_circle_of_folders_is_named_where_no_files_make_one(tmp_path):
    files = {
        "low/one/p.py": "from ..two.q import f",
        "low/one/r.py": "",
        "low/two/q.py": "",
        "low/two/s.py": "from ..one.r import f",
    }
    write(tmp_path / "doseki", SOUND | files)
    (found,) = circles(python_arrows(tmp_path / "doseki"))
    assert found.startswith("low: one, two import each other")


def test_includes_are_read(tmp_path):
    files = {
        "low/a.hpp": '#include <vector>\n#include "../high/d.hpp"\n',
        "low/x.hpp": '#include "y.hpp"\n',
        "low/y.hpp": '#  include "low/x.hpp"\n',
        "high/d.hpp": "",
    }
    write(tmp_path, files)
    arrows = list(cpp_arrows(tmp_path))
    assert back_arrows(arrows, ORDER) == ["low/a.hpp -> high/d.hpp: low may not import high"]
    (found,) = circles(arrows)
    assert found.startswith("low: x.hpp, y.hpp import each other")
