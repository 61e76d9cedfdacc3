"""What VTK itself reads of all that is written; left out where VTK is missing.

`uv pip install vtk` adds it; a picture is drawn without a screen (VTK takes EGL or OSMesa).
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from doseki.export.paraview.write import export_paraview
from doseki.export.polydata import PolyData
from doseki.export.surface.write import SurfaceOptions, export_surface
from doseki.export.vtu import export_vtu
from doseki.record.fields import FIELDS
from doseki.record.reader import load

pytest.importorskip("vtkmodules.vtkIOHDF", reason="VTK is missing: pip install vtk")
READERS = {
    ".vtkhdf": ("vtkIOHDF", "vtkHDFReader"),
    ".vtu": ("vtkIOXML", "vtkXMLUnstructuredGridReader"),
    ".vtp": ("vtkIOXML", "vtkXMLPolyDataReader"),
    ".ply": ("vtkIOPLY", "vtkPLYReader"),
    ".stl": ("vtkIOGeometry", "vtkSTLReader"),
}
BESIDE = {".pvd", ".series", ".json", ".csv", ".py"}  # of exports: what VTK is not to read


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


@pytest.fixture(scope="module")
def everything(pool):
    """A run with all that can be exported of it, and the folders of exports."""
    folder = pool.directory
    export_vtu(pool)
    export_paraview(pool)
    export_surface(pool, SurfaceOptions())
    if pool[0].dim == 3:
        for kind in ("ply", "stl"):
            export_surface(pool, SurfaceOptions(kind), folder / kind)
    folders = [folder / name for name in ("snapshots", "vtu", "paraview", "surface", "ply", "stl")]
    return pool, [each for each in folders if each.is_dir()]


def opened(file):
    """What VTK reads of a file; fails on whatever it says of it."""
    from vtkmodules.vtkCommonCore import vtkCommand

    module, name = READERS[file.suffix]
    reader = getattr(__import__(f"vtkmodules.{module}", fromlist=[name]), name)()
    said = []
    for event in (vtkCommand.ErrorEvent, vtkCommand.WarningEvent):
        reader.AddObserver(event, lambda *words: said.append(words[1]))
    reader.SetFileName(str(file))
    reader.Update()
    assert not said, file
    return reader.GetOutput()


def test_every_file_opens(everything):
    _, folders = everything
    seen = set()
    for file in (f for folder in folders for f in folder.rglob("*") if f.is_file()):
        assert file.suffix in READERS or file.suffix in BESIDE, file
        if file.suffix in READERS:
            seen.add(file.suffix)
            data = opened(file)
            assert data.GetNumberOfPoints() > 0, file
            assert np.isfinite(data.GetBounds()).all(), file
    assert {".vtkhdf", ".vtu", ".vtp"} <= seen


def test_a_damaged_file_does_not_open(everything):
    """The control of the test above."""
    run, _ = everything
    whole = run.directory / "surface/water_000000.vtp"
    damaged = whole.with_name("damaged.vtp")
    damaged.write_bytes(whole.read_bytes().replace(b'Name="Points"', b'Name="Points', 1))
    with pytest.raises(AssertionError):
        opened(damaged)
    damaged.unlink()


def strings(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    return [array.GetValue(k) for k in range(array.GetNumberOfValues())]


def test_units_and_names_are_in_the_files(everything):
    run, _ = everything
    points = opened(run.directory / "vtu/000000.vtu")
    assert strings(points, "MaterialNames") == list(run[0].material_names)
    assert "Velocity [m/s]" in strings(points, "Units")
    surface = opened(run.directory / "surface/water_000001.vtp")
    assert strings(surface, "Material") == ["water"]
    assert surface.GetFieldData().GetArray("TimeValue").GetValue(0) == run.times[1]
    for data, unit in ((points, "m/s"), (surface, "m/s")):
        array = data.GetPointData().GetArray("Velocity")
        assert array.GetInformation().Get(array.UNITS_LABEL()) == unit
    gauges = opened(run.directory / "paraview/gauges.vtp")
    names = gauges.GetCellData().GetAbstractArray("Gauge")
    assert names.GetValue(0) == "toe"


DRAW = """
import sys
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkGlyph3DMapper, vtkPolyDataMapper, vtkRenderer,
    vtkRenderWindow, vtkWindowToImageFilter)
from vtkmodules.vtkFiltersSources import vtkCubeSource
from vtkmodules.vtkIOImage import vtkPNGWriter
import vtkmodules.vtkRenderingOpenGL2
run, picture = sys.argv[1:]
renderer = vtkRenderer()
readers = []
for name in ("surface/water_000001", "paraview/shapes/000001", "paraview/grains/000001"):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(f"{run}/{name}.vtp")
    mapper = vtkPolyDataMapper()
    if "grains" in name:
        mapper, cube = vtkGlyph3DMapper(), vtkCubeSource()
        mapper.SetSourceConnection(cube.GetOutputPort())
        mapper.SetOrientationArray("Orientation")
        mapper.SetOrientationModeToQuaternion()
        mapper.SetScaleArray("BallDiameter")
        mapper.SetScaleModeToScaleByMagnitude()
    mapper.SetInputConnection(reader.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*[(0, 0, 1), (0, 1, 0), (1, 0, 0)][len(readers)])
    actor.GetProperty().SetLighting(False)
    actor.GetProperty().SetLineWidth(4)
    renderer.AddActor(actor)
    readers.append(reader)
renderer.SetBackground(1, 1, 1)
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(400, 300)
window.AddRenderer(renderer)
camera = renderer.GetActiveCamera()
camera.SetPosition(*((0, -1, 0) if DIM == 3 else (0, 0, 1)))
camera.SetViewUp(*((0, 0, 1) if DIM == 3 else (0, 1, 0)))
renderer.ResetCamera()
window.Render()
image = vtkWindowToImageFilter()
image.SetInput(window)
writer = vtkPNGWriter()
writer.SetInputConnection(image.GetOutputPort())
writer.SetFileName(picture)
writer.Write()
"""


def drawn(code, *arguments):
    """The picture (rows, columns, 3) that a script draws into the last of its arguments."""
    from matplotlib.image import imread

    words = [sys.executable, "-c", code, *map(str, arguments)]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    if ended.returncode < 0 or not Path(arguments[-1]).exists():
        said = ended.stderr[-200:]
        pytest.skip(f"VTK cannot draw on this machine: it needs EGL or OSMesa ({said})")
    return imread(arguments[-1])[..., :3]


def test_a_picture_shows_water_and_bodies_where_they_are(everything, tmp_path):
    """In a process of its own: without any OpenGL, VTK may end in a crash."""
    run, _ = everything
    picture = tmp_path / "picture.png"
    code = DRAW.replace("DIM", str(run[0].dim))
    colours = drawn(code, run.directory, picture)
    middles = {}
    for name, colour in (("water", (0, 0, 1)), ("brick", (0, 1, 0)), ("ball", (1, 0, 0))):
        row, column = np.nonzero(np.all(np.abs(colours - colour) < 0.1, axis=2))
        assert len(row) > 30, name
        middles[name] = column.mean(), -row.mean()
    assert middles["water"][0] < middles["ball"][0] < middles["brick"][0]
    assert middles["ball"][1] > middles["water"][1]


GLYPHS = (
    DRAW.partition("for name in")[0]
    + """
reader = vtkXMLPolyDataReader()
reader.SetFileName(run)
bar, mapper = vtkCubeSource(), vtkGlyph3DMapper()
bar.SetYLength(0.2)
mapper.SetSourceConnection(bar.GetOutputPort())
mapper.SetInputConnection(reader.GetOutputPort())
mapper.SetOrientationArray("Orientation")
mapper.SetOrientationModeToQuaternion()
mapper.ScalingOff()
mapper.ScalarVisibilityOff()
actor = vtkActor()
actor.SetMapper(mapper)
actor.GetProperty().SetColor(1, 0, 0)
actor.GetProperty().SetLighting(False)
renderer.AddActor(actor)
"""
    + DRAW.partition("    readers.append(reader)\n")[2].replace("DIM", "2")
)


def test_glyphs_turn_as_bodies_do(tmp_path):
    """A bar turned by 30 degrees about the axis of the viewer."""
    half = np.radians(15)
    turned = np.array([[np.cos(half), 0, 0, np.sin(half)]])
    file = tmp_path / "bar.vtp"
    PolyData(np.zeros((1, 3)), verts=np.zeros((1, 1), int), fields={"Orientation": turned}).write(
        file
    )
    colours = drawn(GLYPHS, file, tmp_path / "bar.png")
    row, column = np.nonzero(colours[..., 1] < 0.5)
    spread = np.cov(column, -row)
    along = np.linalg.eigh(spread)[1][:, 1]
    assert np.degrees(np.arctan2(along[1], along[0])) % 180 == pytest.approx(30, abs=1)
