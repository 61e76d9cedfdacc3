"""What `import doseki` gives: quickly, with words on each, and nothing else."""

from __future__ import annotations

import inspect
import subprocess
import sys

import pytest

import doseki

PROGRAM = """
import sys
import doseki
heavy = {"numpy", "pydantic", "matplotlib", "h5py", "scipy", "rich"}
assert not heavy & set(sys.modules), heavy & set(sys.modules)
doseki.load, doseki.Scenario
late = {"matplotlib", "pandas", "xarray", "doseki._core_scalar", "doseki.solver"}
assert not late & set(sys.modules), late & set(sys.modules)
doseki.run
assert not {"matplotlib.pyplot", "pandas", "xarray"} & set(sys.modules)
assert callable(doseki.run)  # no package of that name has taken its place
"""


def test_importing_it_imports_little():
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", sorted(set(doseki.__all__) - {"__version__"}))
def test_each_name_is_there_and_says_what_it_is(name):
    given = getattr(doseki, name)
    assert name in dir(doseki)
    assert inspect.getdoc(given)
    if inspect.isclass(given) and given.__module__.startswith("doseki.api"):
        public = {key: part for key, part in vars(given).items() if not key.startswith("_")}
        assert all(inspect.getdoc(part) for part in public.values()), public


def test_another_name_is_refused():
    with pytest.raises(AttributeError, match="no attribute 'lod'"):
        doseki.lod  # noqa: B018
