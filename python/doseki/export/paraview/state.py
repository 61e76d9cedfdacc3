"""A state of ParaView 5.11 or later that shows this run; it reads scene.json beside it.

In ParaView: File, Load State. For a picture: pvbatch state.py PICTURE.png [TIME]
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import paraview
from paraview import simple

READS_SNAPSHOTS = (5, 12)  # the first ParaView that reads particles from VTKHDF
SPEED, UNIT = "Velocity", "m/s"
PICTURE = (1600, 900)
FAINT, CLEAR = 0.12, 0.65
GREY, EARTH = (0.62, 0.64, 0.66), (0.74, 0.70, 0.63)
ROCK, RED = (0.2, 0.2, 0.2), (0.8, 0.1, 0.1)
SEEN_FROM = (-0.30, -0.62, 0.72)  # 3-D: of the flow, as a direction in axes whose last is upwards

Colour = tuple[float, float, float]  # red, green, blue, 0 to 1


def folder() -> Path:
    """Where this file stands."""
    places = [Path.cwd(), Path.cwd() / "paraview"]
    if "__file__" in globals():
        places.insert(0, Path(__file__).resolve().parent)
    for place in places:
        if (place / "scene.json").is_file():
            return place
    raise RuntimeError(
        "scene.json is not found: open this by File, Load State, or start ParaView in its folder"
    )


class Stage:
    """The view, and what is put into it."""

    def __init__(self, place: Path) -> None:
        self.place = place
        self.scene = json.loads((place / "scene.json").read_text(encoding="utf-8"))
        self.flat = self.scene["dim"] == 2
        self.view = simple.GetActiveViewOrCreate("RenderView")
        self.colours = simple.GetColorTransferFunction(SPEED)
        self.legend = False

    def opened(self, key: str, name: str) -> Any:
        """The reader of a part of the scene, or None where there is none."""
        if key not in self.scene:
            return None
        return self.read(self.place / self.scene[key], name)

    def read(self, path: Path, name: str) -> Any:
        """The reader of a file, under a name that tells what it is."""
        reader = simple.OpenDataFile(str(path))
        if reader is None:
            raise RuntimeError(f"{path} cannot be read")
        simple.RenameSource(name, reader)
        return reader

    def show(self, source: Any, kind: str = "Surface", colour: Colour | None = None) -> Any:
        """Show a source as surface, points or glyphs, in a colour or by its speed."""
        shown = simple.Show(source, self.view)
        shown.SetRepresentationType(kind)
        if colour is None:
            simple.ColorBy(shown, ("POINTS", SPEED, "Magnitude"))
            self.legend = True
        else:
            shown.ColorArrayName = [None, ""]
            shown.AmbientColor = shown.DiffuseColor = colour
        return shown

    def dots(self, source: Any, colour: Colour | None = None) -> Any:
        """Show particles as balls of their spacing."""
        shown = self.show(source, "Point Gaussian", colour)
        shown.GaussianRadius = 0.55 * self.scene["spacing"]
        shown.ShaderPreset = "Sphere"
        return shown


def between(source: Any, array: str, value: int, name: str) -> Any:
    """The particles whose `array` is `value`."""
    chosen = simple.Threshold(registrationName=name, Input=source)
    chosen.Scalars = ["POINTS", array]
    chosen.LowerThreshold, chosen.UpperThreshold = value, value
    chosen.ThresholdMethod = "Between"
    return chosen


def particles(stage: Stage) -> Any:
    """The snapshots, or the export for older versions; None where neither can be read."""
    run = (stage.place / stage.scene["run"]).resolve()
    version = paraview.simple.GetParaViewVersion()
    index, older = run / "snapshots.vtkhdf.series", run / "vtu" / "run.pvd"
    if (version.major, version.minor) >= READS_SNAPSHOTS and index.is_file():
        return stage.read(index, "particles")
    if older.is_file():
        return stage.read(older, "particles")
    print(
        f"Particles are not shown: ParaView {version.major}.{version.minor} does not read them "
        "from the snapshots, and there is no export; make one with  doseki export DIR --vtu"
    )
    return None


def show_flow(stage: Stage) -> None:
    """What flows: surfaces where they were exported, and particles."""
    run = (stage.place / stage.scene["run"]).resolve()
    surfaces = sorted((run / "surface").glob("*.pvd"))
    for file in surfaces:
        surface = stage.read(file, "surface of " + file.stem)
        shown = stage.show(surface)
        shown.LineWidth = 3.0
        shown.Specular = 0.3
        shown.Opacity = CLEAR if "grains" in stage.scene and not stage.flat else 1.0
    source = particles(stage)
    if source is None:
        return
    simple.Hide(source, stage.view)
    free = between(source, "Motion", 0, "free particles")
    for name, number in stage.scene["fluids"].items():
        flow = between(free, "Material", number, name)
        stage.dots(flow)
        if surfaces and not stage.flat:
            simple.Hide(flow, stage.view)
    simple.Hide(free, stage.view)
    walls = between(source, "Motion", 1, "fixed particles")
    stage.dots(walls, GREY)
    if not stage.flat:
        simple.Hide(walls, stage.view)


def show_grains(stage: Stage) -> None:
    """Bodies that move: balls that carry an arrow along their own first axis, and other shapes."""
    shapes = stage.opened("shapes", "bodies of other shapes")
    if shapes is not None:
        stage.show(shapes)
    grains = stage.opened("grains", "grains")
    if grains is None:
        return
    balls = stage.show(grains, "3D Glyphs")
    glyphs(balls, "Sphere", "BallDiameter", 1.0)
    balls.GlyphType.Radius = 0.5
    balls.GlyphType.ThetaResolution = balls.GlyphType.PhiResolution = 24
    axes = simple.PassThrough(registrationName="own axes of grains", Input=grains)
    arrows = stage.show(axes, "3D Glyphs", ROCK)
    glyphs(arrows, "Arrow", "Diameter", 0.75)
    arrows.GlyphType.ShaftRadius, arrows.GlyphType.TipRadius = 0.06, 0.14


def glyphs(shown: Any, kind: str, size: str, factor: float) -> None:
    """Glyphs turned by the quaternion w, x, y, z of each point."""
    shown.GlyphType = kind
    shown.Scaling, shown.ScaleMode = 1, "Magnitude"
    shown.SelectScaleArray, shown.ScaleFactor = size, factor
    shown.Orient, shown.OrientationMode = 1, "Quaternion"
    shown.SelectOrientationVectors = "Orientation"


def show_structures(stage: Stage) -> None:
    """Fixed bodies, the ground, and gauges with their names."""
    structures = stage.opened("structures", "structures")
    if structures is not None:
        shown = stage.show(structures, "Surface With Edges" if stage.flat else "Surface", GREY)
        shown.Opacity = 1.0 if stage.flat or "ground" in stage.scene else FAINT
    ground = stage.opened("ground", "ground")
    if ground is not None:
        stage.show(ground, "Surface", EARTH).LineWidth = 3.0
    gauges = stage.opened("gauges", "gauges")
    if gauges is not None:
        shown = stage.show(gauges, "Surface", RED)
        shown.PointSize, shown.LineWidth, shown.RenderPointsAsSpheres = 12.0, 4.0, 1
    for name, place in stage.scene["labels"].items():
        text = simple.Text(registrationName="gauge " + name, Text=name)
        label = simple.Show(text, stage.view)
        label.TextPropMode = "Billboard 3D Text"
        label.BillboardPosition = place
        label.Color, label.FontSize, label.Bold = RED, 16, 1


def finish(stage: Stage) -> None:
    """Colours with their units, the time, and where it is seen from."""
    view, scene = stage.view, stage.scene
    stage.colours.ApplyPreset("Viridis (matplotlib)", True)
    stage.colours.RescaleTransferFunction(0.0, scene["speed"])
    stage.colours.AutomaticRescaleRangeMode = "Never"
    if stage.legend:
        bar = simple.GetScalarBar(stage.colours, view)
        bar.Title, bar.ComponentTitle, bar.Visibility = "speed", "[" + UNIT + "]", 1
        bar.TitleColor = bar.LabelColor = (0, 0, 0)
        bar.TitleFontSize = bar.LabelFontSize = 18
        bar.AutomaticLabelFormat, bar.LabelFormat, bar.RangeLabelFormat = 0, "%-#.3g", "%-#.3g"
        bar.ScalarBarThickness, bar.ScalarBarLength = 16, 0.35
    time = simple.AnnotateTime(registrationName="time", Format="t = {time:.3f} s")
    clock = simple.Show(time, view)
    clock.Color, clock.FontSize = (0, 0, 0), 22
    view.UseColorPaletteForBackground, view.Background = 0, (1.0, 1.0, 1.0)
    view.ViewSize = list(PICTURE)
    view.OrientationAxesLabelColor = (0, 0, 0)
    simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    look(stage)


def look(stage: Stage) -> None:
    """Put the camera so that what moves fills the picture."""
    view, scene = stage.view, stage.scene
    low, high, up = scene["low"], scene["high"], scene["up"]
    middle = [(low[k] + high[k]) / 2 for k in range(3)]
    size = max(high[k] - low[k] for k in range(3)) or 1.0
    view.CameraFocalPoint, view.CameraParallelProjection = middle, 1 if stage.flat else 0
    if stage.flat:
        view.InteractionMode = "2D"
        view.CameraPosition = [middle[0], middle[1], middle[2] + 10 * size]
        view.CameraViewUp = [0.0, 1.0, 0.0]
        wide, tall = high[0] - low[0], high[1] - low[1]
        view.CameraParallelScale = 0.65 * max(tall, wide * PICTURE[1] / PICTURE[0])
        return
    view.CameraPosition = [middle[k] + 1.65 * size * SEEN_FROM[k] for k in range(3)]
    view.CameraViewUp = up


def main() -> None:
    """Build the scene; take a picture where one is asked for."""
    simple._DisableFirstRenderCameraReset()
    stage = Stage(folder())
    show_structures(stage)
    show_flow(stage)
    show_grains(stage)
    finish(stage)
    simple.Render(stage.view)
    asked = sys.argv[1:]
    if asked and asked[0].endswith(".png"):
        if len(asked) > 1:
            simple.GetAnimationScene().AnimationTime = float(asked[1])
        simple.SaveScreenshot(asked[0], stage.view, ImageResolution=list(PICTURE))


main()
