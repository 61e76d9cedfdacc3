"""Export to VTU, read back with a small reader of the format."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.export import export_vtu
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


def test_export_never_overwrites(run_folder, tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there/000000.vtu").write_text("mine")
    with pytest.raises(UserError, match="not empty"):
        export_vtu(load(run_folder), tmp_path / "there")
    assert (tmp_path / "there/000000.vtu").read_text() == "mine"
