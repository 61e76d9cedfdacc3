#!/usr/bin/env bash
# On a machine with a graphics card: builds the core for it, tests it, times and profiles it.
#
#     bench/device.sh [FOLDER]
#
# Everything goes to the folder (device-results). What fails is in its log, and the rest goes on, but
# for the build. CUDAARCHS says for which cards (cmake's list), all of them if it does not.
# Cases have two threads so that they are timed by the wall clock.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
out=${1:-device-results}
mkdir -p "$out"

# Runs a command of a name; its output goes to FOLDER/NAME.txt.
step() {
    local name=$1 start=$SECONDS code=0
    shift
    "$@" >"$out/$name.txt" 2>&1 </dev/null || code=$?
    echo "$name: exit code $code after $((SECONDS - start)) s" | tee -a "$out/steps.txt"
}

step card nvidia-smi
doseki=.venv/bin/doseki
step build env DOSEKI_INSTRUCTION_SETS="host;device;cuda" ./doseki list
.venv/bin/python -c "import doseki._core_cuda" 2>>"$out/build.txt" ||
    { echo "no module for a card: see $out/build.txt" | tee -a "$out/steps.txt"; exit 1; }
step requirements ./doseki test core -k nothing
step tests .venv/bin/python -m pytest -q -n 0 -m "isa or not isa" tests/core/device/test_device_runs.py -k cuda
step oracle .venv/bin/python -m pytest -q -n 0 -m "isa or not isa" tests/core/oracle -k cuda
for scheme in ueta2022 resolved; do
    step "bench-$scheme" $doseki bench --scheme "$scheme" --isa cuda --sizes 1e5,1e6,4e6 --threads 2
done
step profile nsys profile --stats=true --force-overwrite=true -o "$out/profile" \
    $doseki bench --scheme resolved --isa cuda --sizes 1e6 --dims 3 --precision double --threads 2
step kernels ncu --set roofline --launch-skip 200 --launch-count 20 \
    $doseki bench --scheme resolved --isa cuda --sizes 1e6 --dims 3 --precision double --threads 2
cat "$out/steps.txt"
