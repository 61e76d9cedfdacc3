"""What VTK itself reads from a snapshot and from an export; left out where VTK is missing."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.export.vtu import export_vtu
from doseki.record.fields import FIELDS
from doseki.record.reader import load

pytest.importorskip("vtkmodules.vtkIOHDF")


def read(reader, path):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = data.GetPointData()
    found = {"Points": vtk_to_numpy(data.GetPoints().GetData())}
    for number in range(arrays.GetNumberOfArrays()):
        found[arrays.GetArrayName(number)] = vtk_to_numpy(arrays.GetArray(number))
    return data, found


def check(data, found, snapshot):
    assert data.GetNumberOfCells() == data.GetNumberOfPoints() == 20
    assert [data.GetCell(k).GetPointId(0) for k in range(20)] == list(range(20))
    for field in FIELDS:
        expected = field.encode(snapshot.stored(field.key))
        assert found[field.file_name].dtype == expected.dtype
        assert np.array_equal(found[field.file_name], expected), field.key


@pytest.mark.parametrize("dim", [2, 3])
def test_vtk_reads_a_snapshot_bit_by_bit(tmp_path, record_run, dim):
    from vtkmodules.vtkIOHDF import vtkHDFReader

    record_run(tmp_path / "run", dim=dim)
    snapshot = load(tmp_path / "run")[1]
    data, found = read(vtkHDFReader(), snapshot.path)
    check(data, found, snapshot)
    assert data.GetFieldData().GetArray("Time").GetValue(0) == 1.0


@pytest.mark.parametrize("dim", [2, 3])
def test_vtk_reads_an_export_bit_by_bit(tmp_path, record_run, dim):
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    record_run(tmp_path / "run", dim=dim)
    run = load(tmp_path / "run")
    export_vtu(run)
    data, found = read(vtkXMLUnstructuredGridReader(), tmp_path / "run/vtu/000001.vtu")
    check(data, found, run[1])
    assert data.GetFieldData().GetArray("TimeValue").GetValue(0) == 1.0
