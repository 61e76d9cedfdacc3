"""The version is that of the tag; commits after it are counted; bare sources have the fallback."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

pytest.importorskip("setuptools_scm", reason="setuptools-scm is not installed: a clone has it")

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"
FALLBACK = tomllib.loads(PROJECT.read_text())["tool"]["setuptools_scm"]["fallback_version"]
ASK = """
from scikit_build_core.metadata.setuptools_scm import dynamic_metadata
print(dynamic_metadata("version"))
"""

needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="no git here")


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """A folder that has the project's settings alone."""
    shutil.copy(PROJECT, tmp_path)
    return tmp_path


def git(folder: Path, *words: str) -> None:
    """Run git without the settings of this machine."""
    who = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false"]
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    environment |= {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    subprocess.run(["git", *who, *words], cwd=folder, env=environment, check=True)


def commit(folder: Path) -> None:
    """Add all there is, and one thing more."""
    with (folder / "more").open("a") as file:
        file.write("x")
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", "more")


def version(folder: Path) -> str:
    """What a build there would be called."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    done = subprocess.run(
        [sys.executable, "-c", ASK],
        cwd=folder, env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout.strip()


def test_sources_without_git_have_the_fallback(sources):
    assert version(sources) == FALLBACK


@needs_git
def test_a_clone_without_tags_counts_commits(sources):
    git(sources, "init", "-q")
    commit(sources)
    commit(sources)
    assert version(sources) == FALLBACK.replace("dev0", "dev2")


@needs_git
def test_a_tag_is_the_version(sources):
    git(sources, "init", "-q")
    commit(sources)
    git(sources, "tag", "-a", "v3.4.5", "-m", "v3.4.5")
    assert version(sources) == "3.4.5"
    commit(sources)
    assert version(sources) == "3.4.6.dev1"


def test_a_source_distribution_knows_its_own(sources):
    (sources / "PKG-INFO").write_text("Metadata-Version: 2.4\nName: doseki\nVersion: 7.8.9\n")
    assert version(sources) == "7.8.9"
