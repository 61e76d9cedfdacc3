"""Memory and threads of the core, watched by the compiler's sanitisers, and the poison mode."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests.fuzz.test_checkpoints import mutate

import doseki

ROOT = Path(__file__).parents[2]
PACKAGE = Path(doseki.__file__).parent
HERE = Path(__file__).parent
SCENES = 10  # that exercise.py goes through, a line each
COMMON = "-fno-omit-frame-pointer"
# Null pointers are found by their addresses. Checks of them and of types take half of the build.
UNDEFINED = "-fno-sanitize-recover=undefined -fno-sanitize=null,vptr"
ADDRESS = f"-fsanitize=address,undefined {UNDEFINED} {COMMON}"
THREAD = f"-fsanitize=thread {COMMON}"


def library(name: str) -> str:
    """Path of a runtime library of the compiler."""
    compiler = os.environ.get("CXX", "c++")
    found = subprocess.run(
        [compiler, f"-print-file-name={name}"], capture_output=True, text=True, check=True
    )
    path = Path(found.stdout.strip())
    if not path.is_absolute():
        pytest.skip(f"the compiler has no {name}")
    return str(path)


def build(folder: Path, flags: str) -> Path:
    """Compile the scalar module with `flags`; returns a folder to import doseki from."""
    program = shutil.which(
        "cmake", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    )
    if program is None:
        pytest.skip("cmake is not installed")
    configure = [
        program,
        "-S",
        ROOT,
        "-B",
        folder / "build",
        f"-DPython_EXECUTABLE={sys.executable}",
        "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
        f"-DCMAKE_CXX_FLAGS={flags}",
        "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-g1 -DNDEBUG",  # lines, not variables: builds faster
        "-DDOSEKI_OPTIMISATION=-O1",
    ]
    for command in (configure, [program, "--build", folder / "build", "--target", "_core_scalar"]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    site = folder / "site/doseki"
    site.mkdir(parents=True)
    sources = [entry for entry in PACKAGE.iterdir() if entry.is_dir() or entry.suffix == ".py"]
    for entry in [*sources, *(folder / "build").glob("_core_scalar*.so")]:
        (site / entry.name).symlink_to(entry)
    (site / "scenarios").symlink_to(ROOT / "scenarios")
    return site.parent


def exercise(
    site: Path, preload: str, threads: int, size: float, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run exercise.py on the module in `site` with runtime libraries loaded before all others.

    Without site packages (-S), for an editable installation of doseki comes before any path.
    """
    environment = {
        "PYTHONPATH": os.pathsep.join([str(site), *filter(None, sys.path)]),
        "LD_PRELOAD": preload,
        "DOSEKI_ISA": "scalar",
    } | variables
    return subprocess.run(
        [sys.executable, "-S", HERE / "exercise.py", str(threads), str(size), site],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def addresses(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """What to load before all others, and the module that watches addresses."""
    preload = f"{library('libasan.so')} {library('libubsan.so')}"
    return preload, build(tmp_path_factory.mktemp("addresses"), ADDRESS)


@pytest.mark.sanitize
@pytest.mark.xdist_group("addresses")  # which are built once for both
def test_addresses_and_undefined_behaviour(addresses):
    preload, site = addresses
    # Python itself frees nothing at its end, which would count as leaks.
    done = exercise(site, preload, 2, 1.0, ASAN_OPTIONS="detect_leaks=0", DOSEKI_POISON="1")
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout.count("\n") == SCENES


@pytest.mark.sanitize
@pytest.mark.xdist_group("addresses")  # which are built once for both
def test_checkpoints_that_somebody_has_changed(addresses, tmp_path):
    preload, site = addresses
    paths = os.pathsep.join([str(site), *filter(None, sys.path)])
    variables = {"PYTHONPATH": paths, "LD_PRELOAD": preload, "DOSEKI_ISA": "scalar"}
    variables |= {"ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1"}
    counts = mutate(2000, tmp_path / "last", ("-S",), **variables)
    assert sum(counts.values()) == 2000


@pytest.mark.sanitize
def test_threads_do_not_race(tmp_path):
    site = build(tmp_path, THREAD)
    shim = tmp_path / "libgomp_threads.so"
    compiler = os.environ.get("CXX", "c++")
    subprocess.run(
        [
            compiler,
            "-std=c++20",
            "-shared",
            "-fPIC",
            "-O1",
            *THREAD.split(),
            HERE / "gomp_threads.cpp",
            "-o",
            shim,
        ],
        check=True,
    )
    preload = f"{library('libtsan.so')} {shim}"
    done = exercise(site, preload, 4, 3.0, TSAN_OPTIONS="exitcode=66")
    assert "WARNING: ThreadSanitizer" not in done.stderr, done.stderr[:3000]
    assert done.returncode == 0, done.stderr[-3000:]
    assert done.stdout.count("\n") == SCENES


POISONED = """
import hashlib, sys
from doseki.solver.build import build_simulation, load_core
from doseki.scenario.load import load_scenario
load_core().set_threads(1)
digest = hashlib.blake2b()
for name in sys.argv[1].split(","):
    simulation, _ = build_simulation(load_scenario(name, sys.argv[2:]))
    simulation.advance(limit=1.0, pause=1.0, max_steps=300)
    for values in simulation.state().values():
        digest.update(values.tobytes())
print(digest.hexdigest())
"""


@pytest.mark.parametrize(
    "arguments",
    [
        ["film,flume,hang", "precision=double"],
        ["film,flume,hang", "precision=mixed"],
        ["film,dambreak", "scheme=resolved", "speed_max=3"],
        ["film,dambreak", "scheme=resolved", "speed_max=3", "precision=mixed"],
    ],
    ids=["double", "mixed", "resolved", "resolved, mixed"],
)
def test_poisoned_records_survive_no_pass_and_change_no_bit(arguments):
    """NaN in every output before each pass: all of it is overwritten before it is read."""
    digests = []
    paths = os.pathsep.join([str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])
    for variables in ({}, {"DOSEKI_POISON": "1"}):
        done = subprocess.run(
            [sys.executable, "-c", POISONED, *arguments],
            env=os.environ | {"PYTHONPATH": paths} | variables,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        digests.append(done.stdout)
    assert digests[0] == digests[1]
