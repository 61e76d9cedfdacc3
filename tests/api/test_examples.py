"""The notebooks in examples/ run from start to end, are typed, and hold no outputs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.ipynb"))
CACHE = ROOT / ".mypy_cache" / "users"  # what users' programs import takes seconds to read
notebooks = pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)


def code_of(path):
    """The cells of code of a notebook, one after the other."""
    cells = nbformat.read(path, as_version=4).cells
    return "\n\n".join(cell.source for cell in cells if cell.cell_type == "code") + "\n"


def execute(path, folder, monkeypatch):
    """A notebook with what its cells give when it runs in a folder of its own."""
    monkeypatch.setenv("IPYTHONDIR", str(folder / "ipython"))
    monkeypatch.setenv("JUPYTER_CONFIG_DIR", str(folder / "jupyter"))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(folder / "runtime"))
    notebook = nbformat.read(path, as_version=4)
    resources = {"metadata": {"path": str(folder)}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=resources).execute()
    return notebook


def pictures(notebook):
    """How many pictures the cells show."""
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return sum("image/png" in output.get("data", {}) for output in outputs)


@pytest.mark.minutes
@notebooks
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    done = execute(path, tmp_path, monkeypatch)
    assert pictures(done) >= 1
    said = [output for cell in done.cells for output in cell.get("outputs", [])]
    errors = "".join(output.text for output in said if output.get("name") == "stderr")
    explained = "doseki warns" in path.read_text(encoding="utf-8")
    assert errors.count("Warning") == errors.count("DosekiWarning") == explained
    assert list((tmp_path / "runs").iterdir())


def test_a_notebook_that_is_wrong_fails(tmp_path, monkeypatch):
    cells = [nbformat.v4.new_code_cell("1 / 0")]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "wrong.ipynb")
    with pytest.raises(CellExecutionError, match="ZeroDivisionError"):
        execute(tmp_path / "wrong.ipynb", tmp_path, monkeypatch)


@notebooks
def test_a_notebook_holds_no_outputs(path):
    text = path.read_text(encoding="utf-8")
    notebook = nbformat.reads(text, as_version=4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        assert cell.get("outputs", []) == []
        assert cell.get("execution_count") is None
    assert text == nbformat.writes(notebook) + "\n"  # as Jupyter saves it


def mypy(folder, *files):
    """What mypy says of programs, strictly."""
    options = ["--strict", "--allow-untyped-calls", f"--cache-dir={CACHE}"]
    command = [sys.executable, "-m", "mypy", *options, *files]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


PROGRAM = """\
import doseki
from typing import assert_type
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes

scenario = doseki.Scenario("flume", dp=0.005).changed({"material.water.rho0": 1200})


def look(view: doseki.LiveView) -> bool:
    assert_type(view.time, float)
    return bool(view["velocity"].max() < 3)


run = doseki.run(scenario, "out", callback=look, every=0.1)
assert_type(run, doseki.Run)
assert_type(doseki.load("out"), doseki.Run)
assert_type(doseki.resume("out"), doseki.Run)
assert_type(run.to_xarray(), xr.Dataset)
assert_type(run.grains, pd.DataFrame)
assert_type(run.history.to_pandas(), pd.DataFrame)
assert_type(run.gauges["a"].to_xarray(), xr.Dataset)
assert_type(run.plot("speed"), Axes)
assert_type(scenario.check().warnings, list[str])
times: np.ndarray = run.times
position: np.ndarray = run[-1]["position"]
"""
FAULTS = {
    "a name that there is not": ("doseki.lod('a')", 'has no attribute "lod"'),
    "an argument": ("doseki.run(scenario, thread=3)", 'Unexpected keyword argument "thread"'),
    "a callback": ("doseki.run(scenario, callback=3)", 'incompatible type "int"'),
    "a method": ("run.to_xaray()", 'has no attribute "to_xaray"'),
}


@pytest.mark.minutes
def test_the_package_is_typed(tmp_path):
    """One call, which takes seconds: a program, the notebooks, and a program that is wrong."""
    (tmp_path / "program.py").write_text(PROGRAM)
    names = ["program.py"]
    for path in EXAMPLES:
        names.append(f"{path.stem.replace('-', '_')}.py")
        (tmp_path / names[-1]).write_text(code_of(path))
    wrong = PROGRAM + "".join(f"{text}\n" for text, _ in FAULTS.values())
    (tmp_path / "wrong.py").write_text(wrong)
    said = mypy(tmp_path, *names, "wrong.py").stdout
    errors = [line for line in said.splitlines() if ": error:" in line]
    assert [line for line in errors if not line.startswith("wrong.py")] == []
    first = len(PROGRAM.splitlines()) + 1
    for number, (_, expected) in enumerate(FAULTS.values(), start=first):
        assert any(f"wrong.py:{number}:" in line and expected in line for line in errors), expected
    assert len(errors) == len(FAULTS)
