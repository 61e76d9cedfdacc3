"""A wheel of this clone, for this processor: what is in it, and that it works by itself."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

pytestmark = [pytest.mark.full, pytest.mark.xdist_group("wheel")]


def find_uv() -> str | None:
    """The uv that ./doseki uses."""
    own = sorted((ROOT / ".tools").glob("uv-*/bin/uv"))
    return str(own[-1]) if own else shutil.which("uv")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Built with the packages of the clone, in a folder of its own: minutes of compiling."""
    uv = find_uv()
    if uv is None:
        pytest.skip("no uv here: ./doseki gets it in a clone")
    folder = tmp_path_factory.mktemp("wheel")
    command = [uv, "build", "--wheel", "--no-build-isolation", "--python", sys.executable]
    options = [f"-Cbuild-dir={folder / 'build'}", "-Ccmake.define.DOSEKI_INSTRUCTION_SETS=host"]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    done = subprocess.run(
        [*command, "-o", str(folder), *options, str(ROOT)],
        capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
    (built,) = folder.glob("doseki-*.whl")
    return built


def test_it_holds_what_it_needs_and_no_more(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    tag = "abi3" if sys.version_info >= (3, 12) else f"cp3{sys.version_info.minor}"
    assert f"-{tag}-" in wheel.name
    modules = [name for name in names if re.fullmatch(r"doseki/_core_\w+\.[\w.-]+\.so", name)]
    assert len(modules) == 1
    assert any(name.startswith("doseki/_core_") and name.endswith(".pyi") for name in names)
    for file in (
        "scenarios/flume.toml",
        "report/browser/viewer.js",
        "cli/main.py",
        "bench/command.py",
    ):
        assert f"doseki/{file}" in names
    assert {name.partition("/")[0] for name in names} == {"doseki", names[-1].partition("/")[0]}
    assert wheel.stat().st_size < 5e6


def test_it_has_the_licences_of_what_is_in_it(wheel):
    archive = zipfile.ZipFile(wheel)
    licences = [name for name in archive.namelist() if ".dist-info/licenses/" in name]
    texts = {name.partition("licenses/")[2]: archive.read(name).decode() for name in licences}
    assert "Permission is hereby granted" in texts["LICENSE"]
    assert "Redistributions in binary form" in texts["nanobind/LICENSE"]
    assert "Permission is hereby granted" in texts["robin-map/robin-map.txt"]


def test_it_runs_where_it_is_installed(wheel, tmp_path):
    """With the packages of this environment, but not the clone that it has doseki from."""
    zipfile.ZipFile(wheel).extractall(tmp_path / "site")
    places = [str(tmp_path / "site"), sysconfig.get_path("purelib"), sysconfig.get_path("platlib")]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(dict.fromkeys(places))}

    def python(*words: str) -> str:
        done = subprocess.run(
            [sys.executable, "-S", *words],
            cwd=tmp_path, capture_output=True, text=True, check=False, env=environment,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return done.stdout

    python("-m", "doseki.cli.main", "run", "collision", "-o", "out", "--json")
    told = python("-c", "import doseki; print(doseki.__file__, doseki.__version__)").split()
    assert Path(told[0]).is_relative_to(tmp_path)
    assert told[1] == wheel.name.split("-")[1]
