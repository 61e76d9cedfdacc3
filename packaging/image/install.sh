# Puts doseki into /opt/doseki of a Debian with the distribution's own Open MPI, from the wheel that lies in
# FOLDER: sh -eu install.sh FOLDER. What only compiling needs is removed again.
export DEBIAN_FRONTEND=noninteractive
building="g++ libopenmpi-dev python3-dev python3-venv"
apt-get -qq update
apt-get -qq -y install --no-install-recommends openmpi-bin libopenmpi3 openssh-client python3 $building >/dev/null

tag=$(python3 -c 'import sys; print("cp311" if sys.version_info < (3, 12) else "abi3")')
python3 -m venv /opt/doseki
/opt/doseki/bin/pip install -q --no-cache-dir "$1"/doseki-*-"$tag"-*.whl
# A wheel of mpi4py would look for the MPI at run time, and find any; compiled here it is bound to this one.
/opt/doseki/bin/pip install -q --no-cache-dir --no-binary mpi4py mpi4py

apt-mark -qq manual python3 openmpi-bin libopenmpi3 openssh-client >/dev/null
apt-get -qq -y purge --auto-remove $building >/dev/null
apt-get -qq clean
rm -rf /var/lib/apt/lists/*
/opt/doseki/bin/doseki --version
