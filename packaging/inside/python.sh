# In the builder: compiles the Python of the Debian DOSEKI_SUITE into /opt/python.
echo "deb-src $(sed -n 's/^deb \([^ ]*\) .*/\1/p' /etc/apt/sources.list | head -n 1) $DOSEKI_SUITE main" \
    >/etc/apt/sources.list.d/source.list
apt-get update -qq
mkdir -p /tmp/python
cd /tmp/python
version=$(apt-cache showsrc python3-defaults | sed -n 's/^Version: \([0-9]*\.[0-9]*\)\..*/\1/p' | sort -V | tail -n 1)
apt-get source -qq --download-only "python$version"
tar -xf python3*.orig.tar.* --strip-components 1
./configure -q --prefix=/opt/python --disable-test-modules --with-ensurepip=no >/dev/null
make -s -j "$(nproc)" >/dev/null 2>&1
make -s install >/dev/null 2>&1
/opt/python/bin/python3 --version
