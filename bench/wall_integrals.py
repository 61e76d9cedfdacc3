#!/usr/bin/env python3
"""Wall particles against boundary integrals: errors of sums over the ground, and what they cost.

../.venv/bin/python wall_integrals.py [compiler options]

Compiles wall_integrals.cpp with the core's headers, c++ and OpenMP, and prints tables.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from doseki.bench.report import markdown_table

HERE = Path(__file__).resolve().parent
METHODS = ["three layers", "local plane", "triangles of dp", "triangles of dp/2"]
COSTS = {
    "particles": "sum over the wall particles of a list",
    "surface": "nearest point of the surface",
    "plane": "local plane, nearest point included",
    "triangles": "triangles of dp, three points each, listed before",
    "fine": "triangles of dp/2, the same",
}


def measured(options: list[str]) -> list[list[str]]:
    """The rows that the compiled program prints."""
    with tempfile.TemporaryDirectory() as folder:
        program = f"{folder}/wall_integrals"
        source = str(HERE / "wall_integrals.cpp")
        include = f"-I{HERE.parent / 'core'}"
        command = ["c++", "-std=c++20", "-O3", "-march=native", "-fopenmp", *options]
        subprocess.run([*command, include, source, "-o", program], check=True)
        done = subprocess.run([program], check=True, capture_output=True, text=True)
    return [line.split() for line in done.stdout.splitlines()]


def main() -> None:
    """Measure and print."""
    rows = measured(sys.argv[1:])
    errors = [row[1:] for row in rows if row[0] == "error"]
    for disorder, words in (("0.0", "on layers"), ("0.1", "moved by dp/10 at most")):
        print(f"\nFluid {words}; rms over 200 particles up to 2 dp above the ground\n")
        names = "ground,method,share,gradient (1/dp),pressure".split(",")
        head = [*names, *(f"{name}, with the fluid" for name in names[2:])]
        body = [
            [ground.replace("_", " "), METHODS[int(method)], *numbers]
            for ground, kind, method, *numbers in errors
            if kind == disorder
        ]
        print(markdown_table(head, body))
    listed = next(row for row in rows if row[0] == "listed")
    print(f"\nlisted for a particle: {listed[1]} wall particles, {listed[2]} triangles of dp\n")
    costs = [[COSTS[row[1]], row[2]] for row in rows if row[0] == "cost"]
    print(markdown_table(["for one fluid particle", "ns"], costs))


if __name__ == "__main__":
    main()
