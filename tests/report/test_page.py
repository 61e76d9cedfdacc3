"""The page: what it says, that it is safe to open, and that it asks nothing of the network."""

from __future__ import annotations

import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image
from tests.synthetic_runs import BODIES, MATERIALS, SCENARIO, history_row, random_state

from doseki.cli.main import main
from doseki.record.writer import Recorder
from doseki.report.markup import Markup, markup, table, tag
from doseki.report.parts.pictures import Album
from doseki.report.report import write_report
from doseki.scenario.gauges.loads.load import Load

from .conftest import give_figure

EVIL = "</title><script>alert(1)</script><img src=x onerror=alert(2)>\"'&"
VOID = {"meta", "img", "input", "br"}


class Page(HTMLParser):
    """A page as parsed: its elements, and the text in each; raises where tags do not match."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements = [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, name, attributes):
        self.elements.append((name, dict(attributes), []))
        if name not in VOID:
            self.open.append(self.elements[-1])

    def handle_endtag(self, name):
        assert self.open.pop()[0] == name

    def handle_data(self, data):
        for _, _, text in self.open:
            text.append(data)

    def all(self, name):
        return [(given, "".join(text)) for found, given, text in self.elements if found == name]

    def by_id(self, wanted):
        (found,) = ["".join(text) for _, given, text in self.elements if given.get("id") == wanted]
        return found


@pytest.fixture
def page_of():
    """A function that writes the report on a run and parses it."""

    def parsed(folder, **options):
        return Page(write_report(folder, **options).path.read_text(encoding="utf-8"))

    return parsed


def test_the_numbers_of_a_run_are_in_it(flow_folder, page_of):
    page = page_of(flow_folder)
    assert page.all("h1")[0][1] == "synthetic"
    summary = page.by_id("summary")
    for words in ("done", "3 s of 2 s", "1 min 15 s", "400 bytes per particle", "dp = 100 mm"):
        assert words in summary
    ledger = page.by_id("ledgers")
    for words in ("at the start5", "entered3", "inside at the end8", "kinetic0.33333.333"):
        assert words in ledger
    assert "thin" in page.by_id("trust")
    assert {given["alt"] for given, _ in page.all("img")} >= {"overview.png", "energy.png"}
    scenario = page.by_id("provenance")
    assert "time_max = 2.0" in scenario
    assert "not recorded" in scenario


def test_sections_come_in_order_and_only_where_there_is_something(drawn_flow, map_run, page_of):
    names = [given["id"] for given, _ in page_of(map_run).all("section")]
    assert names == ["summary", "view", "trust", "ledgers", "figures", "provenance"]
    (drawn_flow / "maps").mkdir()
    Image.new("RGB", (30, 20), "red").save(drawn_flow / "maps" / "arrival_time.png")
    (drawn_flow / "loads.csv").write_text("time [s],force_x [N]\n0.0,12.5\n1.0,-3.25e4\n")
    (drawn_flow / "sections.json").write_text(
        '{"gorge": {"peak": 1.5}, "rows": [{"a": 1}, {"b": "<i>"}]}'
    )
    (drawn_flow / "gauges").mkdir()
    page = page_of(drawn_flow)
    names = [given["id"] for given, _ in page.all("section")]
    assert names[3:8] == ["ledgers", "figures", "maps", "loads", "sections"]
    assert "Time of arrival (s)" in page.by_id("maps")
    assert "-32500" in page.by_id("loads")
    assert "<i>" in page.by_id("sections")
    assert "gorge" in page.by_id("sections")


def test_what_has_no_number_says_why(flow_folder, page_of):
    rows = "body,part,quantity,value\ndam,total,mean over 10 ms,nan\ndam,total,impulse,3.5\n"
    (flow_folder / "loads.csv").write_text(rows)
    said = page_of(flow_folder).by_id("loads")
    assert "nan" not in said
    assert "mean over 10 ms-" in said
    assert "-: no mean over less than the interval of its gauge" in said


def test_gauges_are_drawn(tmp_path, page_of):
    text = SCENARIO.format(dim=2, zeros="") + (
        '\n[gauge.p1]\nkind = "surface_height"\nposition = [0.5, 0.0]\n'
    )
    recorder = Recorder(tmp_path / "run", text, MATERIALS, BODIES, 2)
    recorder.snapshot(random_state(20, 2), time=0.0, step=0, dt=0.1)
    recorder.history(history_row(0.0))
    recorder.gauge("p1", ["time [s]", "height [m]"], [[0.0, 1.0], [1.0, 2.0]])
    recorder.close({"status": "done"})
    page = page_of(tmp_path / "run")
    assert "p1: surface height, 2 rows" in page.by_id("gauges")
    assert "gauge p1" in {given["alt"] for given, _ in page.all("img")}


def test_a_gauge_that_a_figure_shows_is_not_drawn_again(flow_folder, page_of):
    tables = (
        '\n[gauge.press]\nkind = "load"\nbodies = ["bed"]\n'
        '\n[gauge.p1]\nkind = "surface_height"\nposition = [0.5, 0.0]\n'
        '\n[figure.push]\nkind = "load"\ngauge = "press"\n'
        '\n[figure.height]\nkind = "gauge"\ngauge = "p1"\n'
    )
    scenario = flow_folder / "scenario.toml"
    scenario.write_text(scenario.read_text() + tables)
    (flow_folder / "gauges").mkdir()
    push = [
        f"{name} [{unit}]" for name, unit in Load(kind="load", bodies=["bed"]).columns(2).items()
    ]
    for name, columns in (("press", push), ("p1", ["time [s]", "height [m]"])):
        rows = (f"{time}," + ",".join("1" for _ in columns[1:]) for time in range(3))
        text = "\n".join([",".join(columns), *rows, ""])
        (flow_folder / "gauges" / f"{name}.csv").write_text(text)
    give_figure(flow_folder)
    page = page_of(flow_folder)
    assert "gauges" not in {given["id"] for given, _ in page.all("section")}


def test_captions_say_what_a_picture_shows(flow_folder, page_of):
    scenario = flow_folder / "scenario.toml"
    tables = '\n[figure.f1]\nkind = "series"\ncolumns = ["time", "kinetic_energy"]\n'
    named = '\n[figure.f2]\nkind = "snapshot"\ntitle = "The <end>"\n'
    scenario.write_text(scenario.read_text() + tables + named)
    give_figure(flow_folder)
    for name in ("f1", "f2", "before", "speeds", "my-own"):
        Image.new("RGB", (40, 30)).save(flow_folder / "figures" / f"{name}.png")
    captions = [text for _, text in page_of(flow_folder).all("figcaption")]
    assert captions == [
        "Overview: the start, the arrival of the flow, its peak and the end",
        "Particles by material and velocity x",
        "Time and kinetic energy over time",
        "The <end>",
        "my own",
        "Speeds of basalt",
    ]


def test_without_scripts_there_are_no_dead_controls(map_run, drawn_flow, page_of):
    for folder, turns in ((map_run, "turn"), (drawn_flow, "move")):
        page = page_of(folder)
        (view,) = [given for _, given, _ in page.elements if given.get("id") == "viewer"]
        assert "hidden" in view
        assert "Drag to" in page.by_id("viewer")
        assert "needs JavaScript" not in page.by_id("viewer")
        assert "needs JavaScript" in page.by_id("view")
        (label,) = [g["aria-label"] for g, _ in page.all("canvas") if "aria-label" in g]
        assert f"Arrow keys {turns}," in label


def test_nothing_is_fetched(map_run, page_of):
    page = page_of(map_run)
    for name, given, _ in page.elements:
        for key in ("src", "href", "srcset", "action", "data", "poster"):
            assert (
                given.get(key, "data:").startswith("data:image/png;base64,") or key not in given
            ), name
        assert not any(key.startswith("on") or key == "style" for key in given)
    text = (map_run / "report.html").read_text(encoding="utf-8")
    rest = re.sub(r"base64,[\w+/=]+", "", text).replace("http://www.w3.org/2000/svg", "")
    assert not re.search(
        r"https?://|//[a-z]+\.|@import|url\(|\bfetch\(|XMLHttpRequest|WebSocket", rest
    )
    (policy,) = [
        given["content"]
        for given, _ in page.all("meta")
        if given.get("http-equiv") == "Content-Security-Policy"
    ]
    assert policy.startswith("default-src 'none'; img-src data:;")
    assert "unsafe" not in policy
    assert "*" not in policy


def test_what_a_file_says_is_text(tmp_path, page_of):
    text = SCENARIO.format(dim=2, zeros="").replace('"synthetic"', json.dumps(EVIL))
    materials, bodies = (EVIL, "basalt", "aluminium"), (f"</script>{EVIL}", "grain", "bed")
    recorder = Recorder(
        tmp_path / "run", text + f"description = {json.dumps(EVIL)}\n", materials, bodies, 2
    )
    recorder.snapshot(random_state(20, 2), time=0.0, step=0, dt=0.1)
    recorder.history(history_row(0.0))
    recorder.close({"status": "done", "warnings": [EVIL]})
    folder = tmp_path / "run"
    check = {"name": EVIL, "value": 1.0, "limits": [1, 2], "verdict": "bad", "remedy": EVIL}
    (folder / "trust.json").write_text(json.dumps({"verdict": "bad", "checks": [check]}))
    (folder / "provenance.json").write_text(
        json.dumps({"runs": [{"doseki": EVIL, "command": [EVIL]}]})
    )
    (folder / "loads.csv").write_text(f"{EVIL.replace(chr(34), '')},b\n1,2\n")
    page = page_of(folder)
    scripts = page.all("script")
    types = [given.get("type") for given, _ in scripts]
    assert types[0] == "application/json"
    assert types.count(None) == 1  # the viewer
    assert set(types) == {"application/json", "text/plain", None}
    assert not any("onerror" in given for _, given, _ in page.elements)
    assert page.all("h1")[0][1] == EVIL
    assert json.loads(scripts[0][1])["fields"][-1]["names"][0] == bodies[0]


def test_provenance_is_that_of_the_run(write, tmp_path, page_of):
    scenario, folder = write("xi = 0.01\n"), tmp_path / "out"
    for words in (["run", scenario, "-o", str(folder), "--set", "time_max=1e-4", "--no-figures"],
                  ["report", str(folder)]):  # fmt: skip
        with pytest.raises(SystemExit) as ended:
            main(words)
        assert ended.value.code == 0
    (entry,) = json.loads((folder / "provenance.json").read_text())["runs"]
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    said = page.by_id("provenance")
    for words in (entry["doseki"], entry["core"], entry["libraries"]["numpy"], entry["processor"]):
        assert words in said
    assert "commit" in said


def test_a_failed_run_says_why(map_run, page_of):
    said = {"kind": "speed", "step": 7, "time": 0.5, "message": "too <fast>", "advice": "raise xi"}
    (map_run / "failure.json").write_text(json.dumps(said))
    text = page_of(map_run).by_id("trust")
    assert "Why it failed" in text
    assert "after step 7" in text


def test_the_inputs_are_named_with_their_digests(drawn_flow, page_of):
    (drawn_flow / "inputs").mkdir()
    (drawn_flow / "inputs" / "bed.csv").write_text("x,y\n")
    text = page_of(drawn_flow).by_id("provenance")
    assert "bed.csv" in text
    assert re.search(r"[0-9a-f]{32}", text)


def test_markup_escapes_all_but_itself():
    assert markup(["<", None, Markup("<b>"), ["&"]]) == "&lt;<b>&amp;"
    assert (
        tag("p", "a\x00b", title='"', hidden=True, id=None)
        == '<p title="&quot;" hidden>a\ufffdb</p>'
    )
    made = Page(table(["a", "b"], [("x", "1.5"), ("y", "-2e3")]))
    assert [given.get("class") for given, _ in made.all("td")] == [None, "number"] * 2
    assert [given.get("class") for given, _ in made.all("th")] == [None, "number"]
    made = Page(table(["a", "b", "c"], [("1", "-", "-"), ("-", "x", ""), ("", "2", "-")]))
    assert [given.get("class") for given, _ in made.all("td")] == ["number", None, None] * 3


def test_a_run_without_snapshots_has_a_report_without_a_view(tmp_path, page_of):
    Recorder(tmp_path / "run", SCENARIO.format(dim=2, zeros=""), MATERIALS, BODIES, 2)
    page = page_of(tmp_path / "run")
    assert "no snapshot yet" in page.by_id("view")
    assert page.all("script") == []
    assert "has not ended" in page.all("header")[0][1]


def test_a_large_picture_is_made_smaller_or_left_out(drawn_flow, page_of):
    (drawn_flow / "maps").mkdir()
    random = np.random.default_rng(1).integers(0, 255, (900, 3000, 3), np.uint8)
    Image.fromarray(random).save(drawn_flow / "maps" / "depth.png")
    (drawn_flow / "maps" / "fake.png").write_text("<script>")
    for size, width in ((20, "2000"), (1.5, "1200"), (0.7, "700")):
        widths = {
            given["alt"]: given["width"]
            for given, _ in page_of(drawn_flow, size_mb=size).all("img")
        }
        assert widths["depth.png"] == width
        assert "fake.png" not in widths
        assert (drawn_flow / "report.html").stat().st_size < 1e6 * size
    written = write_report(drawn_flow, size_mb=0.1)
    assert any("depth.png is left out" in note for note in written.notes)
    assert any("fake.png is left out" in note for note in written.notes)


def test_one_picture_that_is_too_large_costs_no_other():
    """Maps and loads come first; of the others each that still fits stays."""
    album = Album(sizes=[50, 900, 30, 40], matters=[True, True, False, False])
    assert album.without(100) == {1, 3}


def test_one_picture_alone_is_one(drawn_flow):
    random = np.random.default_rng(1).integers(0, 255, (600, 900, 3), np.uint8)
    Image.fromarray(random).save(drawn_flow / "figures" / "first.png")
    notes = write_report(drawn_flow, size_mb=2).notes
    assert any(note.startswith("1 picture is shown") for note in notes)


def test_the_file_is_no_larger_than_it_may_be(map_run):
    for size in (0.5, 0.1, 0.08):
        assert write_report(map_run, size_mb=size).size < 1e6 * size


def test_maps_and_loads_stay_longest(drawn_flow, page_of):
    """All pictures are made smaller before one is left out, and of these first what is neither."""
    random = np.random.default_rng(1).integers(0, 255, (600, 900, 3), np.uint8)
    for name in ("figures/first", "maps/depth", "loads/dam"):
        (drawn_flow / name).parent.mkdir(exist_ok=True)
        Image.fromarray(random).save(drawn_flow / f"{name}.png")
    sizes = {}
    for size in (20, 3, 0.6):
        images = page_of(drawn_flow, size_mb=size).all("img")
        sizes[size] = {given["alt"]: int(given["width"]) for given, _ in images}
    assert sizes[20] | {"first.png": 900, "depth.png": 900, "dam.png": 900} == sizes[20]
    assert sizes[3] | {"first.png": 700, "depth.png": 700, "dam.png": 700} == sizes[3]
    written = write_report(drawn_flow, size_mb=0.6)
    assert sizes[0.6] | {"depth.png": 450, "dam.png": 450} == sizes[0.6]
    assert "first.png" not in sizes[0.6]
    assert written.size < 0.6e6
    assert any("first.png is left out" in note for note in written.notes)
    assert any("pictures are shown 450 pixels wide" in note for note in written.notes)
