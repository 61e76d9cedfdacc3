"""The view in a browser: it is drawn, it follows what it is asked for, and it is true to scale."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.geodata.grid import Raster
from doseki.geodata.ground import Profile, write_ground
from doseki.geodata.raster import write_raster
from doseki.record.reader import load
from doseki.report.report import write_report

from .browser import needs_browser, picture_of, state_of, text_of, told
from .conftest import CORNER

pytestmark = [needs_browser, pytest.mark.minutes]
YELLOW, VIOLET = (253, 231, 37), (68, 1, 84)  # the ends of the colour scale


def near(picture, colour, by=45):
    """Number of pixels of about a colour."""
    return int(np.sum(np.abs(picture - colour).max(axis=2) < by))


def changed(a, b):
    """Number of pixels that differ."""
    return int(np.sum(np.abs(a - b).max(axis=2) > 30))


@pytest.fixture
def page(map_run):
    """The report on the run on a map."""
    return write_report(map_run).path


def test_the_view_says_what_it_shows(page, map_run, tmp_path):
    run = load(map_run)
    state = state_of(page, "field=pressure&frame=3", tmp_path / "profile")
    assert state["ready"]
    assert (state["field"], state["frame"], state["frames"]) == ("pressure", 3, 5)
    assert state["time"] == pytest.approx(0.75)
    assert (state["flow"], state["bodies"], state["walls"]) == (240, 1, 360)
    snapshot = run[3]
    water = snapshot["position"][~snapshot["fixed"] & (snapshot["grain"] < 0)]
    assert np.allclose(state["extent"], [water.min(axis=0), water.max(axis=0)], rtol=0, atol=5e-5)
    assert 460000 < state["target"][0] < 460003
    assert state["high"] == pytest.approx(9810 * 0.45)  # of what moves


def test_colours_and_places_follow_what_is_asked_for(page, tmp_path):
    asked = (
        "field=speed&frame=0",
        "field=material&frame=0",
        "field=speed&frame=4",
        "field=speed&frame=0&zoom=3",
        "field=speed&frame=0&clear=1",
    )
    speed, material, later, closer, clear = (
        picture_of(page, text, tmp_path / f"profile{k}") for k, text in enumerate(asked)
    )
    assert near(speed, YELLOW) > 150
    assert near(speed, VIOLET) > 300
    for other in (material, later, closer, clear):
        assert changed(speed, other) > 3000
    water_blue = (49, 130, 189)
    assert near(material, water_blue, 60) > near(speed, water_blue, 60) + 2000


def test_terrain_is_drawn(map_run, tmp_path):
    soil = (205, 191, 163)
    without = picture_of(write_report(map_run).path, "elevation=60", tmp_path / "without")
    heights = CORNER[2] - 0.5 + 0.02 * np.add.outer(np.arange(40.0), np.zeros(60))
    raster = Raster(heights, CORNER[0] - 1.0, CORNER[1] - 1.5, 0.1)
    write_raster(map_run / "terrain.asc", raster)
    page = write_report(map_run).path
    state = state_of(page, "", tmp_path / "profile")
    assert state["terrain"]
    assert not state["cut"]  # what stands in front on a map may be the dam
    terrain = picture_of(page, "elevation=60", tmp_path / "with")
    assert near(terrain, soil, 25) > near(without, soil, 25) + 20000
    (map_run / "terrain.asc").write_text("ncols 5\nnrows")
    written = write_report(map_run)
    assert any("terrain.asc is left out" in note for note in written.notes)
    state = state_of(page, "", tmp_path / "profile")
    assert not state["terrain"]
    assert state["cut"]


def test_the_ground_of_a_slice_is_drawn_below_its_flow(drawn_flow, tmp_path):
    soil = (205, 191, 163)
    without = picture_of(write_report(drawn_flow).path, "", tmp_path / "without")
    write_ground(drawn_flow, Profile(np.array([-1.0, 9.0]), np.array([-0.1, -0.1])))
    page = write_report(drawn_flow).path
    assert state_of(page, "", tmp_path / "profile")["terrain"]
    drawn = picture_of(page, "", tmp_path / "with")
    assert near(drawn, soil, 25) > near(without, soil, 25) + 5000


def test_a_flat_run_is_drawn_face_on_in_place(drawn_flow, tmp_path):
    page = write_report(drawn_flow).path
    state = state_of(page, "field=body&frame=0", tmp_path / "profile")
    assert state["dim"] == 2
    assert state["legend"] == ["sea", "grain", "bed"]
    first, last = (
        picture_of(page, f"field=material&frame={k}", tmp_path / f"p{k}") for k in (0, 12)
    )
    assert changed(first, last) > 800


def test_names_that_are_programs_do_not_run(tmp_path, record_run):
    folder = tmp_path / "run"
    record_run(folder)[0].close(
        {"status": "done", "warnings": ["<script>document.title='ran'</script>"]}
    )
    page = write_report(folder).path
    text = page.read_text(encoding="utf-8")
    # Even a script that gets into the page is refused: its digest is not in the policy.
    page.write_text(
        text.replace("</main>", "</main><script>document.body.innerHTML=''</script>"), "utf-8"
    )
    assert state_of(page, "", tmp_path / "profile")["ready"]


# What a hand does: a drag, the wheel, keys, the box of a layer, play; then the state is read again.
HAND = """
const canvas = part("picture");
const finger = (kind, id, x, y) => canvas.dispatchEvent(
  new PointerEvent(kind, { pointerId: id, clientX: x, clientY: y, bubbles: true, buttons: 1 }));
tell(doseki.state());
finger("pointerdown", 1, 300, 300);
finger("pointermove", 1, 380, 320);
finger("pointerup", 1, 380, 320);
tell(doseki.state());
finger("pointerdown", 1, 300, 300);
finger("pointerdown", 2, 400, 300);
finger("pointermove", 2, 500, 300);
finger("pointerup", 1, 300, 300);
finger("pointerup", 2, 500, 300);
tell(doseki.state());
canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: 120, ctrlKey: true, cancelable: true }));
tell(doseki.state());
canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "." }));
await rest(500);
tell(doseki.state());
part("play").click();
await rest(3000);
tell(doseki.state());
part("play").click();
part("top").click();
const select = part("field");
select.value = "depth";
select.dispatchEvent(new Event("change"));
await rest(500);
tell(doseki.state());
"""


def test_it_follows_the_hand(page, tmp_path):
    states = told(page, "frame=1", HAND, tmp_path / "profile")
    first, turned, pinched, wheeled, keyed, played, chosen = states
    assert turned["azimuth"] < first["azimuth"]
    assert turned["elevation"] > first["elevation"]
    assert turned["target"] == first["target"]
    assert pinched["height"] == pytest.approx(turned["height"] / 2, rel=0.01)
    assert pinched["target"] != turned["target"]
    assert wheeled["height"] > pinched["height"]
    assert (first["frame"], keyed["frame"]) == (1, 2)
    assert played["playing"]
    assert played["frame"] != 2
    assert not chosen["playing"]
    assert (chosen["field"], chosen["elevation"]) == ("depth", 89)


# The last moment, from which playing goes on with the first one; a number that is none.
LAST = """
addEventListener("error", (event) => tell(event.message));
await doseki.show({ frame: 4 });
part("play").click();
part("picture").dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
await rest(50);
tell(doseki.state());
await rest(400);
part("play").click();
tell(doseki.state());
await doseki.show({ frame: 4 });
part("play").click();
part("play").click();
await doseki.show({ frame: NaN, azimuth: NaN, zoom: NaN });
tell(doseki.state());
"""


def test_play_goes_on_from_the_last_moment(page, tmp_path):
    pressed, played, twice = told(page, "frame=1", LAST, tmp_path / "profile")
    assert pressed["frame"] == 4
    assert pressed["playing"]
    assert played["frame"] < 4
    assert (twice["frame"], twice["playing"]) == (4, False)
    assert twice["azimuth"] == played["azimuth"]
    assert twice["height"] == pytest.approx(played["height"])


ADDRESSES = """
for (const asked of ["frame=3&field=material&zoom=2&clear=1", "azimuth=10&frame=x", "trust"]) {
  location.hash = asked;
  await rest(500);
  tell(doseki.state());
}
"""


def test_an_address_is_followed_later_too(page, tmp_path):
    first, second, place = told(page, "frame=1&field=depth", ADDRESSES, tmp_path / "profile")
    assert (first["frame"], first["field"], first["clear"]) == (3, "material", True)
    assert first["height"] < 0.6 * second["height"]
    # What an address does not name is as at the start: here the last moment is the liveliest.
    assert (second["frame"], second["field"], second["clear"]) == (4, "speed", False)
    assert second["azimuth"] == 10
    assert {**place, "drawn": 0} == {**second, "drawn": 0}


LEGEND = """
await doseki.show({ field: "pressure" });
tell(part("legend").textContent);
[...part("layers").querySelectorAll("label")].find((box) => box.textContent === "bodies").click();
tell(part("legend").textContent);
"""


def test_the_legend_names_what_is_drawn(page, tmp_path):
    with_bodies, without = told(page, "", LEGEND, tmp_path / "profile")
    assert "rigid bodies" in with_bodies
    assert "rigid bodies" not in without
    assert "fixed" in without


def test_without_a_graphics_processor_there_are_no_dead_controls(page, tmp_path):
    text = text_of(page, tmp_path / "profile", "--disable-3d-apis")
    body = text[text.index("<body>") : text.index("<script")]
    assert "cannot be shown here" in body
    assert "Drag to" not in body
    assert "Colour" not in body
