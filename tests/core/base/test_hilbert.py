"""The curve along which cells are stored visits each once, by steps to the next cell."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

CORE = Path(__file__).parents[3] / "core"
PROGRAM = r"""
#include "cells/hilbert.hpp"
using namespace doseki;

template <int D>
constexpr int distance(std::uint32_t a, std::uint32_t b, int bits) {
    int sum = 0;
    for (int axis = 0; axis < D; ++axis) {
        int difference = 0;
        for (int bit = 0; bit < bits; ++bit)
            difference += (int(a >> (bit * D + axis) & 1) - int(b >> (bit * D + axis) & 1)) << bit;
        sum += difference < 0 ? -difference : difference;
    }
    return sum;
}

template <int D>
constexpr bool goes_from_cell_to_cell(int bits) {
    std::array<std::uint32_t, 4096> key_at{};
    std::array<bool, 4096> seen{};
    const std::uint32_t cells = 1u << (bits * D);
    for (std::uint32_t key = 0; key < cells; ++key) {
        const std::uint32_t index = hilbert_index<D>(key, bits);
        if (index >= cells || seen[index]) return false;
        seen[index] = true, key_at[index] = key;
    }
    for (std::uint32_t n = 1; n < cells; ++n)
        if (distance<D>(key_at[n - 1], key_at[n], bits) != STEP) return false;
    return key_at[0] == 0;
}

static_assert(goes_from_cell_to_cell<2>(0) && goes_from_cell_to_cell<2>(1));
static_assert(goes_from_cell_to_cell<2>(3) && goes_from_cell_to_cell<2>(4));
static_assert(goes_from_cell_to_cell<3>(1) && goes_from_cell_to_cell<3>(3));
"""


@pytest.mark.skipif(not shutil.which("g++"), reason="no g++ here")
@pytest.mark.parametrize(("step", "holds"), [(1, True), (2, False)])
def test_the_curve_goes_from_cell_to_cell(tmp_path, step, holds):
    source = tmp_path / "hilbert.cpp"
    source.write_text(PROGRAM.replace("STEP", str(step)))
    command = ["g++", "-std=c++20", "-fsyntax-only", "-fconstexpr-ops-limit=100000000"]
    ended = subprocess.run([*command, f"-I{CORE}", source], capture_output=True, text=True)
    assert (ended.returncode == 0) == holds, ended.stderr
