"""What pyproject.toml promises of an installed package, and what the recipes of wheels rely on."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRA = re.compile(r"doseki\[(\w+)\]")
MESSAGES = ("python/doseki/**/*.py", "README.md", "docs/*.md")
PACKAGING = ROOT / "packaging"


def extras_named(text: str) -> set[str]:
    """The extras that a text tells its reader to install."""
    return set(EXTRA.findall(text))


def test_extras_that_messages_name_exist():
    named = set()
    for pattern in MESSAGES:
        for file in ROOT.glob(pattern):
            named |= extras_named(file.read_text(encoding="utf-8"))
    assert {"mpi", "terrain"} <= named
    assert named <= set(PROJECT["project"]["optional-dependencies"])


def test_an_extra_is_found_however_it_is_quoted():
    assert extras_named("pip install 'doseki[one]' or doseki[two]: doseki three") == {"one", "two"}


def find_nvcc(path: Path, folders: Path) -> subprocess.CompletedProcess[str]:
    """What the build does to find CUDA's compiler, with this path and these folders."""
    cmake = shutil.which("cmake")
    assert cmake, "the build has put cmake on the path of tests"
    return subprocess.run(
        [cmake, f"-Dnvcc_folders={folders}", "-P", ROOT / "core/device/nvcc.cmake"],
        env={"PATH": str(path)},
        capture_output=True,
        text=True,
    )


def test_without_nvcc_a_build_for_cards_says_what_to_install(tmp_path):
    done = find_nvcc(tmp_path, tmp_path)
    assert done.returncode != 0
    said = " ".join(done.stderr.split())
    assert "cuda needs nvcc" in said
    assert "pip install 'doseki[cuda]'" in said


@pytest.mark.parametrize("on_path", [True, False])
def test_nvcc_is_found_on_the_path_and_among_packages(tmp_path, on_path):
    there, nowhere = tmp_path / "bin", tmp_path / "empty"
    there.mkdir(), nowhere.mkdir()
    (there / "nvcc").write_text("#!/bin/sh\n")
    (there / "nvcc").chmod(0o755)
    folders = (there, nowhere) if on_path else (nowhere, there)
    assert find_nvcc(*folders).returncode == 0


def test_a_clone_and_a_wheel_are_built_with_the_same():
    required = PROJECT["build-system"]["requires"]
    assert all("==" in line for line in required)
    assert set(required) <= set(PROJECT["dependency-groups"]["build"])
    pinned = (ROOT / "requirements.txt").read_text(encoding="utf-8").splitlines()
    assert set(required) <= set(pinned)


def test_the_version_is_of_the_tag_and_has_a_fallback():
    assert "version" not in PROJECT["project"]
    assert PROJECT["project"]["dynamic"] == ["version"]
    assert re.fullmatch(r"\d+\.\d+\.dev0", PROJECT["tool"]["setuptools_scm"]["fallback_version"])


def test_the_licence_is_there():
    project = PROJECT["project"]
    assert project["license"] == "MIT"
    assert all((ROOT / name).is_file() for name in project["license-files"])


def test_every_tool_of_the_wheels_is_pinned():
    def names(file: str) -> set[str]:
        lines = (PACKAGING / file).read_text(encoding="utf-8").splitlines()
        return {re.split(r"[\[=; ]", line)[0] for line in lines if not line.startswith("#")}

    assert names("requirements.in") <= names("requirements.txt")


@pytest.mark.skipif(shutil.which("sh") is None, reason="no sh here")
def test_scripts_are_shell():
    scripts = sorted(PACKAGING.rglob("*.sh"))
    assert len(scripts) >= 6
    for script in scripts:
        subprocess.run(["sh", "-n", str(script)], check=True)


@pytest.mark.parametrize("script", ["doseki", ".ci/run", "packaging/build_wheels.sh"])
def test_what_readers_type_as_a_command_may_be_run(script):
    if not (ROOT / script).exists():
        pytest.skip(f"{script} is not in a source distribution")
    assert os.access(ROOT / script, os.X_OK)


def test_files_that_recipes_name_exist():
    text = "".join(path.read_text(encoding="utf-8") for path in (PACKAGING / "image").iterdir())
    text += (
        (PACKAGING / "build_wheels.sh")
        .read_text(encoding="utf-8")
        .replace("$packaging", "packaging")
    )
    named = set(re.findall(r"packaging/[\w./]+\w", text))
    assert "packaging/image/install.sh" in named
    assert [name for name in named if not (ROOT / name).exists()] == []
