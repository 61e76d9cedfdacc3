# In a bare Debian: the steps of the recipes in packaging/image, then a run on two ranks of its Open MPI.
sh -eu /dist/install.sh /dist
PATH=/opt/doseki/bin:$PATH
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
! command -v g++ || exit 1
mkdir /work
cd /work
mpiexec --oversubscribe -n 2 doseki run dambreak --set time_max=0.03 -o started --threads 1
doseki run dambreak --set time_max=0.03 --ranks 2 -o starting --threads 1
python - <<'PYTHON'
from mpi4py import MPI

print(MPI.Get_library_version().split(",")[0])
assert "Open MPI" in MPI.Get_library_version()
PYTHON
