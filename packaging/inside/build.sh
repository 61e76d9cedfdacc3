# In the builder: the source distribution of /source, and from it a wheel for each Python, into /out.
platform=manylinux_2_28_x86_64

python3 -m venv /opt/tools
/opt/tools/bin/pip install -q -r /packaging/requirements.txt
PATH=/opt/tools/bin:$PATH
python=/opt/tools/bin/python

# Modules are linked against the C library of /old. Its libgomp is the one that they bring along: that of
# the builder needs a newer C library.
mkdir -p /opt/old
libraries=/old/usr/lib/x86_64-linux-gnu
cp -L "$libraries/libgomp.so.1" /opt/old/
ln -s libgomp.so.1 /opt/old/libgomp.so
gcc -O2 -fPIC -fvisibility=hidden -fno-builtin -c /packaging/old_glibc.c -o /opt/old/old_glibc.o
LDFLAGS="--sysroot=/old -L/opt/old -L$libraries -L/old/lib/x86_64-linux-gnu -static-libstdc++"
LDFLAGS="$LDFLAGS -Wl,--wrap=exp,--wrap=log,--wrap=pow /opt/old/old_glibc.o -lpthread"
export LDFLAGS

git config --global --add safe.directory /source
uv build --sdist --python /usr/bin/python3 -o /out /source
mkdir /doseki
tar -xf /out/doseki-*.tar.gz -C /doseki --strip-components 1

# What computes knows nothing of Python: the second wheel has it from the compiler's cache, which wants the same
# names of compiler and folder.
export CC=gcc CXX=g++
export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_DIR=/ccache
export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
for interpreter in /usr/bin/python3 /opt/python/bin/python3; do
    rm -rf /raw /doseki/build
    uv build --wheel --python "$interpreter" -o /raw /doseki -C build-dir=build/wheel \
        -C cmake.define.DOSEKI_INSTRUCTION_SETS=all \
        -C cmake.define.OpenMP_gomp_LIBRARY=/opt/old/libgomp.so
    LD_LIBRARY_PATH=/opt/old auditwheel repair --plat "$platform" -w /repaired /raw/doseki-*.whl
done
$python /packaging/finish_wheels.py /out /repaired/*.whl
abi3audit --strict /out/*-abi3-*.whl

# With the old C library, the modules of each wheel lack nothing but Python.
for wheel in /out/*.whl; do
    rm -rf /unpacked
    $python -m zipfile -e "$wheel" /unpacked
    for module in /unpacked/doseki/_core_*.so; do
        LD_TRACE_LOADED_OBJECTS=1 LD_BIND_NOW=1 LD_WARN=yes \
            LD_LIBRARY_PATH=/old/lib/x86_64-linux-gnu:$libraries \
            /old/lib64/ld-linux-x86-64.so.2 "$module" >/bound 2>&1
        grep -q "libm.so.6 => /old/" /bound
        if grep -E 'undefined symbol|not found' /bound | grep -v 'symbol: _*Py'; then exit 1; fi
    done
done
