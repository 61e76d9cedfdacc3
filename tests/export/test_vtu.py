"""Export to VTU, read back with a small reader of the format."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.export.vtu import export_vtu
from doseki.record.reader import load

TYPES = {"Float64": np.float64, "Int32": np.int32, "Int64": np.int64, "UInt8": np.uint8}


def read_vtu(path):
    """Arrays by name from a .vtu with raw appended data."""
    content = path.read_bytes()
    start = content.index(b'<AppendedData encoding="raw">\n_')
    root = ET.fromstring(content[:start] + b"</VTKFile>")
    raw = content[content.index(b"_", start) + 1 :]
    arrays = {}
    for element in root.iter("DataArray"):
        if element.get("format") != "appended":
            continue
        offset = int(element.get("offset"))
        length = int(np.frombuffer(raw, np.uint64, 1, offset)[0])
        values = np.frombuffer(raw[offset + 8 : offset + 8 + length], TYPES[element.get("type")])
        arrays[element.get("Name")] = values.reshape(-1, int(element.get("NumberOfComponents")))
    return arrays


def test_export_holds_what_was_recorded(run_folder):
    run = load(run_folder)
    export_vtu(run)
    arrays = read_vtu(run_folder / "vtu/000002.vtu")
    assert np.array_equal(arrays["Points"][:, :2], run[2]["position"])
    assert np.array_equal(arrays["Stress"][:, 3], run[2]["stress"][:, 0, 1])
    assert np.array_equal(
        np.array(run[2].material_names)[arrays["Material"][:, 0]], run[2]["material"]
    )
    assert np.array_equal(arrays["connectivity"][:, 0], np.arange(20))


def test_collection_gives_files_and_times(run_folder):
    collection = export_vtu(load(run_folder))
    entries = list(ET.parse(collection).getroot().iter("DataSet"))
    assert [float(entry.get("timestep")) for entry in entries] == [0.0, 1.0, 2.0]
    assert all((collection.parent / entry.get("file")).is_file() for entry in entries)


@pytest.mark.parametrize("inside", [True, False])
def test_export_goes_through_no_link(run_folder, tmp_path, inside):
    """A link in the run's folder, or one that is named, leads to an empty folder elsewhere."""
    outside, link = tmp_path / "outside", (run_folder / "vtu" if inside else tmp_path / "link")
    outside.mkdir()
    link.symlink_to(outside)
    with pytest.raises(UserError, match="symbolic link"):
        export_vtu(load(run_folder), None if inside else link)
    assert not any(outside.iterdir())


def test_a_refused_export_leaves_nothing_in_the_way(run_folder):
    last = run_folder / "snapshots/000002.vtkhdf"
    before, whole = sorted(run_folder.iterdir()), last.read_bytes()
    run = load(run_folder)
    assert len(run) == 3
    last.write_bytes(b"damaged")
    with pytest.raises(UserError, match="000002"):
        export_vtu(run)
    assert sorted(run_folder.iterdir()) == before
    last.write_bytes(whole)
    assert export_vtu(load(run_folder)).is_file()


def test_export_never_overwrites(run_folder, tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there/000000.vtu").write_text("mine")
    with pytest.raises(UserError, match="not empty"):
        export_vtu(load(run_folder), tmp_path / "there")
    assert (tmp_path / "there/000000.vtu").read_text() == "mine"
