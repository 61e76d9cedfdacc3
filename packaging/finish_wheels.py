"""Finishes repaired wheels: licences of what they bring along, a bill of materials, checks.

    python finish_wheels.py OUTPUT WHEEL...

Runs in the builder (inside/build.sh): licences and versions are those of the packages that were
linked.
"""

from __future__ import annotations

import gzip
import re
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.model.license import LicenseExpression
from cyclonedx.output.json import JsonV1Dot6
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator
from elftools.elf.elffile import ELFFile
from packageurl import PackageURL

SOURCE = Path("/source")
BUILDER = Path("/")
OLD = Path("/old")  # the system whose C library and libgomp were linked
GPL = Path("/usr/share/common-licenses/GPL-3")
GCC_LICENCE = "GPL-3.0-or-later WITH GCC-exception-3.1"
LICENCE = f"MIT AND BSD-3-Clause AND {GCC_LICENCE}"
MAX_BYTES = 15_000_000


@dataclass(frozen=True)
class Part:
    """Something that is in a wheel: what it is, the package that it came in, its licence."""

    name: str
    version: str
    licence: str
    package: PackageURL

    def component(self) -> Component:
        """The entry of the bill of materials."""
        return Component(
            type=ComponentType.LIBRARY,
            name=self.name,
            version=self.version,
            licenses=[LicenseExpression(self.licence)],
            purl=self.package,
            bom_ref=self.name,
        )


def gcc_documents(system: Path) -> Path:
    """The folder with the copyright and the changelog of a system's gcc."""
    return max(system.glob("usr/share/doc/gcc-[0-9]*-base"))


def of_gcc(name: str, system: Path) -> Part:
    """A library of gcc, with the version of the source package that it was built from."""
    with gzip.open(gcc_documents(system) / "changelog.Debian.gz", "rt", encoding="utf-8") as file:
        source, version = re.match(r"(\S+) \(([^)]+)\)", file.readline()).groups()
    package = PackageURL("deb", "debian", source, version, {"arch": "source"})
    return Part(name, version, GCC_LICENCE, package)


def nanobind_version() -> str:
    """As the build requires it."""
    required = tomllib.loads((SOURCE / "pyproject.toml").read_text())["build-system"]["requires"]
    return next(line for line in required if line.startswith("nanobind==")).partition("==")[2]


def parts() -> list[Part]:
    """What is linked into the modules, or lies beside them."""
    nanobind = nanobind_version()
    package = PackageURL("pypi", None, "nanobind", nanobind)
    return [
        Part("nanobind", nanobind, "BSD-3-Clause", package),
        Part("robin-map", f"of nanobind {nanobind}", "MIT", package),
        of_gcc("libstdc++", BUILDER),
        of_gcc("libgomp", OLD),
    ]


def bill(version: str) -> str:
    """The bill of materials as CycloneDX 1.6 in JSON; raises ValueError where it is not valid."""
    bom = Bom()
    root = Component(
        type=ComponentType.APPLICATION,
        name="doseki",
        version=version,
        licenses=[LicenseExpression("MIT")],
        purl=PackageURL("pypi", None, "doseki", version),
        bom_ref="doseki",
    )
    bom.metadata.component = root
    components = [part.component() for part in parts()]
    for component in components:
        bom.components.add(component)
    bom.register_dependency(root, components)
    text = JsonV1Dot6(bom).output_as_string(indent=1)
    if wrong := JsonStrictValidator(SchemaVersion.V1_6).validate_str(text):
        raise ValueError(f"the bill of materials: {wrong}")
    return text + "\n"


def unbound_symbols(module: Path) -> list[str]:
    """Names that a module wants and that neither Python nor a version of a library promises."""
    with module.open("rb") as file:
        elf = ELFFile(file)
        versions = elf.get_section_by_name(".gnu.version")
        return [
            symbol.name
            for k, symbol in enumerate(elf.get_section_by_name(".dynsym").iter_symbols())
            if symbol["st_shndx"] == "SHN_UNDEF"
            and symbol["st_info"]["bind"] == "STB_GLOBAL"
            and versions.get_symbol(k)["ndx"] in {"VER_NDX_LOCAL", "VER_NDX_GLOBAL"}
            and not symbol.name.startswith(("Py", "_Py"))
        ]


def check_modules(package: Path) -> None:
    """All instruction sets are there, and load on the oldest system promised; else ValueError."""
    modules = sorted(package.glob("_core_*.so"))
    if len(modules) != 3:
        raise ValueError(f"modules: {[module.name for module in modules]}; expected v4, v3, scalar")
    for module in modules:
        if names := unbound_symbols(module):
            raise ValueError(f"{module.name} wants {', '.join(names)} of no library")


def add_licences(information: Path) -> None:
    """Licences of gcc's libraries beside those that the build has put there, and their names."""
    folder = information / "licenses"
    for name, text in {
        "libstdc++/copyright": gcc_documents(BUILDER) / "copyright",
        "libgomp/copyright": gcc_documents(OLD) / "copyright",
        "GPL-3": GPL,
    }.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(text.read_bytes())
    names = sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file())
    for part in ("nanobind", "robin-map"):
        if not any(name.startswith(f"{part}/") for name in names):
            raise ValueError(f"the licence of {part} is missing")
    metadata = information / "METADATA"
    head, blank, body = metadata.read_text(encoding="utf-8").partition("\n\n")
    lines = [line for line in head.splitlines() if not line.startswith("License-")]
    lines += [f"License-Expression: {LICENCE}", *(f"License-File: {name}" for name in names)]
    metadata.write_text("\n".join(lines) + blank + body, encoding="utf-8")


def finish(wheel: Path, output: Path) -> Path:
    """The finished wheel in the folder `output`."""
    tool = [sys.executable, "-m", "wheel"]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*tool, "unpack", "-d", folder, str(wheel)], check=True)
        (tree,) = Path(folder).iterdir()
        (information,) = tree.glob("doseki-*.dist-info")
        check_modules(tree / "doseki")
        add_licences(information)
        (information / "sboms").mkdir(exist_ok=True)
        version = information.name.removesuffix(".dist-info").partition("-")[2]
        (information / "sboms" / "doseki.cdx.json").write_text(bill(version), encoding="utf-8")
        subprocess.run([*tool, "pack", "-d", str(output), str(tree)], check=True)
    finished = output / wheel.name
    if finished.stat().st_size > MAX_BYTES:
        raise ValueError(f"{finished.name}: {finished.stat().st_size} bytes, over {MAX_BYTES}")
    return finished


def main() -> None:
    """Finishes the wheels that the command line names."""
    output, *wheels = map(Path, sys.argv[1:])
    for wheel in wheels:
        finished = finish(wheel, output)
        print(f"{finished.name}: {finished.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
