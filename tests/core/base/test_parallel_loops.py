"""Loops over particles and tasks visit each once; reductions do not depend on the threads."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

CORE = Path(__file__).parents[3] / "core"
PROGRAM = r"""
#include <cmath>
#include <cstdio>
#include "base/parallel.hpp"
using namespace doseki;

int main() {
    for (const std::size_t n : {0ul, 1ul, light_loop - 1, light_loop, light_loop + 1, 100000ul})
        for (const int threads : {1, 2, 3, 7}) {
            set_threads(threads);
            const double total = reduce(n, 0.0, std::plus{}, [](std::size_t p) {
                return std::sin(static_cast<double>(p));
            });
            const double largest = reduce(n, 0.0, maximum, [](std::size_t p) {
                return static_cast<double>(p * 7919 % 100003);
            });
            const bool all = reduce(n, true, std::logical_and{}, [n](std::size_t p) {
                return p + 1 != n;
            });
            std::vector<int> visits(n);
            for_each_particle(n, [&](std::size_t p) { ++visits[p]; });
            for_each_task(n, 16, [&](std::size_t thread, std::size_t k) {
                visits[k] += thread < static_cast<std::size_t>(threads) ? 1 : 100;
            });
            const bool once = reduce(n, true, std::logical_and{}, [&](std::size_t p) {
                return visits[p] == 2;
            });
            std::printf("%zu %d %a %.17g %d %d\n", n, threads, total, largest, all, once);
        }
}
"""


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    """What the program prints: n, threads, sum, maximum, all, once."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    if compiler is None:
        pytest.skip("no C++ compiler on the path")
    folder = tmp_path_factory.mktemp("loops")
    (folder / "loops.cpp").write_text(PROGRAM, encoding="utf-8")
    command = [compiler, "-std=c++20", "-O1", "-fopenmp", "-I", CORE, "loops.cpp", "-o", "loops"]
    subprocess.run(command, cwd=folder, check=True)
    done = subprocess.run([folder / "loops"], capture_output=True, text=True, check=True)
    return [line.split() for line in done.stdout.splitlines()]


def test_sums_are_the_same_bits_on_any_number_of_threads(rows):
    for n in {row[0] for row in rows}:
        assert len({row[2] for row in rows if row[0] == n}) == 1, n


def test_maxima_and_all_are_exact(rows):
    for n, _, _, largest, everything, _ in rows:
        count = int(n)
        assert float(largest) == max((p * 7919 % 100003 for p in range(count)), default=0)
        assert int(everything) == (count == 0)


def test_each_is_visited_once(rows):
    assert rows
    assert all(once == "1" for *_, once in rows)
