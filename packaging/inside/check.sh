# In a system with Python and no compiler: installs the wheel of /dist and uses it, then runs the fast tests of
# the source distribution beside it.
for compiler in cc c++ gcc g++ clang; do
    ! command -v "$compiler" || { echo "there is a compiler: $compiler" >&2; exit 1; }
done
wheel=$(ls /dist/*.whl)
python3 -m venv /venv
/venv/bin/pip install -q "$wheel"
PATH=/venv/bin:$PATH
mkdir /work
cd /work

doseki --version
doseki list
python /dist/start_up.py
for isa in $(python -c 'from doseki.compiled import available_instruction_sets as all; print(*all())'); do
    DOSEKI_ISA=$isa doseki run collision -o "collision-$isa"
done
doseki run flume --set time_max=0.01
doseki run dambreak --set time_max=0.1 -o dambreak
doseki plot dambreak
doseki export dambreak --vtu

# Ranks are an extra: without it one sentence says so.
! doseki run collision --ranks 2 -o never 2>said || exit 1
grep 'pip install doseki\[mpi\]' said
/venv/bin/pip install -q "$wheel[mpi]"
doseki run dambreak --set time_max=0.03 --ranks 2 -o ranks

# The fast tests, with all extras; without those of the clone's own house and pages. Only the installed package
# may be imported.
mkdir /tests
tar -xf /dist/doseki-*.tar.gz -C /tests --strip-components 1
rm -r /tests/python
cd /tests
extras=$(python -c 'import importlib.metadata as m; print(*m.metadata("doseki").get_all("Provides-Extra"), sep=",")')
/venv/bin/pip install -q "$wheel[$extras]" hypothesis ipykernel nbclient nbformat pytest pytest-xdist
python -m tests.tiers fast -q --durations=0 --durations-min=5 --ignore=tests/house --ignore=tests/docs
