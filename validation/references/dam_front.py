#!/usr/bin/env python3
"""The front of a dam break without friction: volume of fluid, by OpenFOAM's interFoam.

.venv/bin/python validation/references/dam_front.py [CELLS ...]

The tank of python/doseki/validate/cases/free_surfaces/dam-front.toml: a column of water a wide and
2a high, in air, with slip on all walls, no viscosity to speak of, no surface tension and no gate.
The front is where the volume fraction in the lowest two rows of cells falls below one half.
Prints, for CELLS cells over a (20, 28 and 40), when the front passes the places Z = x/a in
T = t sqrt(2 g/a), then the rows of python/doseki/validate/data/dam-front-vof.csv: what they tend
to, as a first-order error leaves it, and by how much the finest is off. Takes some ten minutes.
Debian: apt-get install openfoam.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

A, G = 0.146, 9.81  # m, m/s2
PLACES = (2.0, 2.5, 3.0, 3.5, 4.0, 4.5)
LENGTH, HEIGHT = 5, 3  # of the tank, in a
TIMES = np.linspace(0, 3.6, 181)  # T of the samples
SCALE = np.sqrt(2 * G / A)

HEADER = "FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"
WALLS = ("left", "right", "floor")


def write(folder: Path, name: str, text: str, kind: str = "dictionary") -> None:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(HEADER.format(kind=kind, name=path.name) + text)


def field(folder: Path, name: str, dimensions: str, value: str, wall: str, top: str) -> None:
    kind = "volVectorField" if value.startswith("(") else "volScalarField"
    patches = "".join(f"{patch} {{ {wall} }}\n" for patch in WALLS)
    write(
        folder,
        f"0/{name}",
        f"dimensions {dimensions};\ninternalField uniform {value};\nboundaryField {{\n{patches}"
        f"top {{ {top} }}\nsides {{ type empty; }}\n}}\n",
        kind,
    )


def write_mesh(folder: Path, cells: int) -> None:
    corners = [
        (x, y, z)
        for z in (0, 0.1 * A)
        for x, y in ((0, 0), (LENGTH, 0), (LENGTH, HEIGHT), (0, HEIGHT))
    ]
    points = " ".join(f"({x * A} {y * A} {z})" for x, y, z in corners)
    write(
        folder,
        "system/blockMeshDict",
        f"""convertToMeters 1;
vertices ({points});
blocks (hex (0 1 2 3 4 5 6 7) ({LENGTH * cells} {HEIGHT * cells} 1) simpleGrading (1 1 1));
edges ();
boundary (
left {{ type wall; faces ((0 4 7 3)); }}
right {{ type wall; faces ((1 2 6 5)); }}
floor {{ type wall; faces ((0 1 5 4)); }}
top {{ type patch; faces ((3 7 6 2)); }}
sides {{ type empty; faces ((0 3 2 1) (4 5 6 7)); }}
);
mergePatchPairs ();
""",
    )
    write(
        folder,
        "system/setFieldsDict",
        "defaultFieldValues (volScalarFieldValue alpha.water 0);\n"
        f"regions (boxToCell {{ box (0 0 -1) ({A} {2 * A} 1);\n"
        "fieldValues (volScalarFieldValue alpha.water 1); });\n",
    )


def write_physics(folder: Path) -> None:
    phase = "{ transportModel Newtonian; nu [0 2 -1 0 0 0 0] %g; rho [1 -3 0 0 0 0 0] %g; }"
    write(
        folder,
        "constant/transportProperties",
        f"phases (water air);\nwater {phase % (1e-9, 1000)}\nair {phase % (1e-9, 1.2)}\n"
        "sigma [1 0 -2 0 0 0 0] 0;\n",
    )
    write(folder, "constant/turbulenceProperties", "simulationType laminar;\n")
    write(
        folder,
        "constant/g",
        f"dimensions [0 1 -2 0 0 0 0];\nvalue (0 -{G} 0);\n",
        "uniformDimensionedVectorField",
    )
    zero = "type zeroGradient;"
    field(folder, "alpha.water", "[0 0 0 0 0 0 0]", "0", zero,
          "type inletOutlet; inletValue uniform 0; value uniform 0;")  # fmt: skip
    field(folder, "U", "[0 1 -1 0 0 0 0]", "(0 0 0)", "type slip;",
          "type pressureInletOutletVelocity; value uniform (0 0 0);")  # fmt: skip
    field(folder, "p_rgh", "[1 -1 -2 0 0 0 0]", "0", "type fixedFluxPressure; value uniform 0;",
          "type totalPressure; p0 uniform 0; value uniform 0;")  # fmt: skip


def write_numerics(folder: Path, cells: int) -> None:
    write(
        folder,
        "system/controlDict",
        f"""application interFoam; startFrom startTime; startTime 0; stopAt endTime;
endTime {TIMES[-1] / SCALE}; deltaT {1e-4 * 20 / cells};
writeControl adjustableRunTime; writeInterval {TIMES[1] / SCALE};
purgeWrite 0; writeFormat ascii; writePrecision 8; timeFormat general; timePrecision 8;
adjustTimeStep yes; maxCo 0.3; maxAlphaCo 0.3; maxDeltaT 1;
""",
    )
    write(
        folder,
        "system/fvSchemes",
        """ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes {
div(rhoPhi,U) Gauss linearUpwind grad(U);
div(phi,alpha) Gauss vanLeer;
div(phirb,alpha) Gauss linear;
div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; }
snGradSchemes { default corrected; }
""",
    )
    write(
        folder,
        "system/fvSolution",
        """solvers {
"alpha.water.*" { nAlphaCorr 2; nAlphaSubCycles 1; cAlpha 1; MULESCorr yes; nLimiterIter 5;
solver smoothSolver; smoother symGaussSeidel; tolerance 1e-8; relTol 0; }
"pcorr.*" { solver PCG; preconditioner DIC; tolerance 1e-5; relTol 0; }
p_rgh { solver PCG; preconditioner DIC; tolerance 1e-7; relTol 0.05; }
p_rghFinal { $p_rgh; relTol 0; }
U { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-6; relTol 0; }
}
PIMPLE { momentumPredictor no; nOuterCorrectors 1; nCorrectors 3; nNonOrthogonalCorrectors 0; }
relaxationFactors { equations { ".*" 1; } }
""",
    )


def run(folder: Path, program: str) -> None:
    log = folder / f"{program}.log"
    with log.open("w") as output:
        done = subprocess.run([program, "-case", str(folder)], stdout=output, stderr=output)
    if done.returncode:
        raise SystemExit(f"{program} failed:\n{log.read_text()[-2000:]}")


def front(time: Path, cells: int) -> float:
    """Z where the water of the lowest two rows ends, between the centres of two cells."""
    text = (time / "alpha.water").read_text()
    numbers = re.search(r"internalField\s+nonuniform[^(]*\(([^)]*)\)", text)
    if numbers is None:
        raise SystemExit(f"{time}: no field of the volume fraction")
    rows = np.fromstring(numbers.group(1), sep=" ").reshape(HEIGHT * cells, LENGTH * cells)
    share = rows[:2].mean(axis=0)
    last = int(np.flatnonzero(share > 0.5)[-1])
    if last + 1 == len(share):
        return float(LENGTH)
    beyond = (share[last] - 0.5) / (share[last] - share[last + 1])
    return (last + 0.5 + beyond) / cells


def arrivals(cells: int) -> np.ndarray:
    """T at which the front passes each of PLACES."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for make in (write_mesh, write_numerics):
            make(folder, cells)
        write_physics(folder)
        for program in ("blockMesh", "setFields", "interFoam"):
            run(folder, program)
        times = sorted(
            (float(each.name), each)
            for each in folder.iterdir()
            if re.fullmatch(r"[0-9.e-]+", each.name)
        )
        t = np.array([time * SCALE for time, _ in times])
        z = np.array([front(each, cells) for _, each in times])
    ahead = np.maximum.accumulate(z)
    return np.array([np.interp(place, ahead, t) for place in PLACES])


def main() -> None:
    os.environ.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")  # where Debian puts it
    resolutions = [int(word) for word in sys.argv[1:]] or [20, 28, 40]
    table = []
    print("cells over a,", ", ".join(f"Z = {place}" for place in PLACES))
    for cells in resolutions:
        table.append(arrivals(cells))
        print(cells, ", ".join(f"{T:.4f}" for T in table[-1]), sep=", ", flush=True)
    if len(table) > 1:  # what is left of a first-order error
        ratio = resolutions[-1] / resolutions[-2]
        limit = table[-1] + (table[-1] - table[-2]) / (ratio - 1)
        print("rows of the table: limit, Z, finest less limit")
        for T, place, finest in zip(limit, PLACES, table[-1], strict=True):
            print(f"{T:.4f},{place},{abs(finest - T):.4f}")


if __name__ == "__main__":
    main()
