"""Who writes a pair term that lacks something is told what, in a sentence."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

CORE = Path(__file__).parents[3] / "core"
TERM = """
#include "pairs/pair_term.hpp"
using namespace doseki;

struct Term {{
    {numbers}
    {accumulators}
    {load}
    {load_moving}
    {load_fixed}
    {add}
    {add_fixed}
}};
{epilogue}
static_assert(check_pair_term<Term, Epilogue>());
static_assert(PairTerm<Term>);
"""
PARTS = {
    "numbers": "using Real = double; static constexpr int dim = 2;",
    "accumulators": "template <class T> using Accumulators = Vec<T, 2>;",
    "load": "template <class Rows> auto load(Rows) const { return typename Rows::Number(0); }",
    "load_moving": "template <class T> T load_moving(OneRow<T>) const { return T(1); }",
    "load_fixed": "template <class T> T load_fixed(OneRow<T>) const { return T(2); }",
    "add": "template <class T> void add(Vec<T, 2>&, const Pair<T, 2>&, T, T) const {}",
    "add_fixed": "template <class T> void add_fixed(Vec<T, 2>&, const Pair<T, 2>&, T, T) const {}",
    "epilogue": "struct Epilogue { void operator()(std::size_t, const Vec<double, 2>&) const {} };",
}
LACKING = {
    "numbers": "a pair term needs `using Real = double` (or float)",
    "accumulators": "a pair term needs `template <class T> using Accumulators",
    "load": "a pair term needs `load(rows) const`",
    "load_moving": "a pair term needs `load_moving(OneRow<T> j) const`",
    "load_fixed": "a pair term needs `load_fixed(OneRow<T> j) const`",
    "add": "a pair term needs `add(Accumulators<T>&, const Pair<T, D>&, i, j)",
    "add_fixed": "a pair term needs `add_fixed(Accumulators<T>&, const Pair<T, D>&, i, j)",
}


def compiled(source: str, folder: Path) -> tuple[bool, str]:
    """Whether the compiler takes `source`, and what it says."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    if compiler is None:
        pytest.skip("no C++ compiler on the path")
    file = folder / "term.cpp"
    file.write_text(source, encoding="utf-8")
    command = [compiler, "-std=c++20", "-fsyntax-only", "-I", CORE, file]
    environment = os.environ | {"LC_ALL": "C"}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    return done.returncode == 0, done.stderr


def test_a_complete_term_is_taken(tmp_path):
    good, said = compiled(TERM.format(**PARTS), tmp_path)
    assert good, said


@pytest.mark.parametrize("missing", LACKING)
def test_what_is_missing_is_said(missing, tmp_path):
    good, said = compiled(TERM.format(**(PARTS | {missing: ""})), tmp_path)
    assert not good
    assert LACKING[missing] in said


def test_an_epilogue_of_other_sums_is_refused(tmp_path):
    epilogue = "struct Epilogue { void operator()(std::size_t, const Mat<double, 3>&) const {} };"
    good, said = compiled(TERM.format(**(PARTS | {"epilogue": epilogue})), tmp_path)
    assert not good
    assert "an epilogue is called as epilogue(p, sums)" in said
