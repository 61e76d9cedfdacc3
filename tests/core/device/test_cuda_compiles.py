"""The pair sums and the point physics are device code as well: nvcc compiles them."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

CORE = Path(__file__).parents[3] / "core"
KERNELS = ("sum_velocity_gradient", "sum_momentum", "point_physics")
PROPERTIES = re.compile(
    r"Function properties for (?P<name>\S+)\s+"
    r"\d+ bytes stack frame, (?P<stores>\d+) bytes spill stores, "
    r"(?P<loads>\d+) bytes spill loads\s+"
    r"ptxas info\s*: Used (?P<registers>\d+) registers"
)


@pytest.mark.minutes
def test_shared_sources_compile_for_a_device_without_spills(tmp_path):
    nvcc = shutil.which("nvcc")
    if nvcc is None:
        print("no nvcc on the path: device code is not compiled")
        pytest.skip("no nvcc on the path")
    built = tmp_path / "pair_terms.o"
    command = [
        nvcc,
        "-arch=sm_90",
        "-std=c++20",
        "--expt-relaxed-constexpr",
        "-Werror",
        "all-warnings",
    ]
    command += ["-Xptxas", "-v", "-I", CORE, "-c", CORE / "device" / "pair_terms.cu", "-o", built]
    done = subprocess.run(command, capture_output=True, text=True)
    report = done.stdout + done.stderr
    assert done.returncode == 0, report
    assert built.stat().st_size > 0

    found = set()
    for match in PROPERTIES.finditer(report):
        name = match["name"]
        # The mangled name: length, kernel, I, d or f, Li, dimensions, E.
        kernel, real, dim = re.search(r"\d+([a-z_]+)I([df])Li([23])E", name).groups()
        found.add((kernel, real, dim))
        print(f"{kernel} {real} {dim}-D: {match['registers']} registers")
        if real == "d":
            assert int(match["stores"]) == int(match["loads"]) == 0, name
    assert found == {(kernel, real, dim) for kernel in KERNELS for real in "df" for dim in "23"}
