"""The core is the code of a graphics card as well: nvcc compiles it, and nothing spills."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import nanobind
import pytest

CORE = Path(__file__).parents[3] / "core"
BIN = Path(sys.executable).parent
UNITS = {
    "resolved": '#include "resolved/evaluate.hpp"\ntemplate class doseki::Resolved<3, double>;\n',
    "ueta2022": '#include "ueta2022/evaluate.hpp"\n#include "ueta2022/pair_probe.hpp"\n'
    "template class doseki::Ueta2022<3, double>;\n",
    "lists": '#include "device/row_lists.cpp"\n',
    "cells": '#include "cells/sorted_cells.cpp"\n',
    "bodies": '#include "bodies/particles/rigid_particles.cpp"\n'
    '#include "boundaries/moving_walls.cpp"\n'
    '#include "boundaries/driven_particles.cpp"\n'
    '#include "bodies/particles/deformable_particles.cpp"\n',
    "contacts": '#include "bodies/steps/contact_pushes.cpp"\n'
    '#include "bodies/steps/rigid_steps.cpp"\n'
    '#include "bodies/steps/rigid_contacts.cpp"\n',
    "solids": '#include "bodies/deformable/solid_steps.cpp"\n',
}
LEAST_KERNELS = {
    "resolved": 10,
    "ueta2022": 8,
    "lists": 4,
    "cells": 6,
    "bodies": 12,
    "contacts": 36,
    "solids": 14,
}
# Of kernels, and of functions that they call, which have no line of registers.
PROPERTIES = re.compile(
    r"Function properties for (?P<name>\S+)\s+"
    r"\d+ bytes stack frame, (?P<stores>\d+) bytes spill stores, "
    r"(?P<loads>\d+) bytes spill loads"
    r"(\s+ptxas info\s*: Used (?P<registers>\d+) registers)?"
)
OPTIONS = [
    "-arch=sm_90", "-std=c++20", "-rdc=true", "--expt-relaxed-constexpr",
    "-Werror", "all-warnings", "-DDOSEKI_SCALAR", "-DDOSEKI_DEVICE", "-DDOSEKI_CUDA",
    "-Xptxas", "-v",
]  # fmt: skip


@pytest.mark.minutes
@pytest.mark.parametrize("unit", UNITS)
def test_kernels_compile_without_spills(tmp_path, unit):
    nvcc = shutil.which("nvcc")
    if nvcc is None:
        print("no nvcc on the path: device code is not compiled")
        pytest.skip("no nvcc on the path")
    source, built = tmp_path / f"{unit}.cu", tmp_path / f"{unit}.o"
    source.write_text(UNITS[unit])
    done = subprocess.run(
        [nvcc, *OPTIONS, "-I", CORE, "-c", source, "-o", built], capture_output=True, text=True
    )
    report = done.stdout + done.stderr
    assert done.returncode == 0, report
    functions = list(PROPERTIES.finditer(report))
    for function in functions:
        print(f"{function['registers']} registers: {function['name']}")
        assert int(function["stores"]) == int(function["loads"]) == 0, function["name"]
    kernels = [function for function in functions if function["registers"]]
    assert len(kernels) >= LEAST_KERNELS[unit]


@pytest.mark.minutes
def test_what_the_compiler_of_the_processor_compiles_of_the_module(tmp_path):
    """By the commands of the build itself; they see what both compilers share."""
    if shutil.which("nvcc") is None:
        print("no nvcc on the path: the module for cards is not compiled")
        pytest.skip("no nvcc on the path")
    settings = {
        "DOSEKI_INSTRUCTION_SETS": "cuda", "CMAKE_EXPORT_COMPILE_COMMANDS": "ON",
        "CMAKE_CUDA_ARCHITECTURES": "90", "Python_EXECUTABLE": sys.executable,
        "nanobind_DIR": nanobind.cmake_dir(), "CMAKE_MAKE_PROGRAM": BIN / "ninja",
        "SKBUILD_STATE": "editable", "SKBUILD_PROJECT_NAME": "doseki",
        "SKBUILD_PROJECT_VERSION": "0",
    }  # fmt: skip
    told = [f"-D{key}={value}" for key, value in settings.items()]
    cmake = [BIN / "cmake", "-G", "Ninja", "-S", CORE.parent, "-B", tmp_path, *told]
    subprocess.run(cmake, check=True, capture_output=True)
    commands = json.loads((tmp_path / "compile_commands.json").read_text())
    ours = [
        entry
        for entry in commands
        if "_core_cuda_compute.dir" in entry["output"] and entry["file"].startswith(str(CORE))
    ]
    assert len(ours) > 5
    for entry in ours:
        command = [*shlex.split(entry["command"]), "-fsyntax-only"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
