"""Bodies that stand in a terrain: the ground has no wall particles where they have theirs."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.kinds.registry import body_of
from doseki.solver.room import remainder_of

from .scenes import grid, profile, simulation_of, text

POOL = """
[body.pool]
shape = "box"
material = "water"
min = [1.0, 0.0]
max = [1.6, 0.4]
[body.dam]
shape = "box"
material = "basalt"
fixed = true
wall = "free_slip"
normal = [-1, 0]
min = [{x}, -0.4]
max = [2.2, 0.6]
{more}
"""
MOVING = "[body.dam.motion]\nvelocity = [0, 1]\nstart = 0.5\n"


def walls(path):
    """Places (N, dim) and volumes (N,) of the wall particles of the ground, before any step."""
    simulation, names = simulation_of(path)
    state = simulation.state()
    bed = state["body"] == names.index("terrain")
    return state["position"][bed], (state["mass"] / state["density"])[bed]


def pool(folder, x=1.6, more="", shift=(0.0, 0.0)):
    profile(folder / "terrain.csv", lambda x: 0 * x, 0.0, 4.0, shift=shift)
    path = folder / "case.toml"
    path.write_text(text(2, dp=0.1, more=POOL.format(x=x, more=more)))
    return path


@pytest.mark.parametrize("x", [1.6, 1.61, 1.625, 1.65, 1.69])
def test_the_ground_ends_where_the_dam_begins(tmp_path, x):
    """Its volume beside the dam is right wherever the face is, and nothing of it lies inside."""
    place, volume = walls(pool(tmp_path, x))
    assert place[:, 0].max() < x
    for layer in (0.05, 0.15):
        row = np.abs(place[:, 1] + layer) < 1e-9
        from_middle = row & (place[:, 0] > 1.4)
        assert volume[from_middle].sum() == pytest.approx(0.1 * (x - 1.4), abs=1.1e-3)
        gaps = np.diff(np.append(np.sort(place[row, 0]), x + 0.05))
        assert gaps.max() < 0.1 + 1e-9, "nothing gets through between them"


def test_what_moves_leaves_the_ground_whole(tmp_path):
    """The control: with a motion that has not begun the ground goes on below the dam."""
    place, volume = walls(pool(tmp_path, more=MOVING))
    assert place[:, 0].max() > 1.7
    assert volume == pytest.approx(np.full(len(volume), 0.01))


def test_a_cut_ground_does_not_depend_on_where_the_map_lies(tmp_path):
    for name in ("near", "far"):
        (tmp_path / name).mkdir()
    near = walls(pool(tmp_path / "near", 1.63))
    path = pool(tmp_path / "far", 1.63, shift=(2048.0, 1024.0))
    moved = ["body.pool.min=[2049, 1024]", "body.pool.max=[2049.6, 1024.4]"]
    moved += ["body.dam.min=[2049.63, 1023.6]", "body.dam.max=[2050.2, 1024.6]"]
    case = path.read_text()
    for entry in moved:
        key, value = entry.split("=")
        _, name, end = key.split(".")
        head, table = case.split(f"[body.{name}]\n")
        lines = [f"{end} = {value}" if r.startswith(f"{end} =") else r for r in table.split("\n")]
        case = f"[body.{name}]\n".join([head, "\n".join(lines)])
    path.write_text(case)
    far = walls(path)
    order = [np.lexsort(np.round(place.T, 6)) for place in (near[0], far[0] - [2048, 1024])]
    assert near[0][order[0]] == pytest.approx(far[0][order[1]] - [2048, 1024], abs=1e-9)
    assert near[1][order[0]] == pytest.approx(far[1][order[1]], rel=1e-9)


BODIES = """
[body.box]
shape = "box"
material = "basalt"
fixed = true
normal = [-1, 0, 0]
min = [2.03, 1.02, -1.0]
max = [3.03, 3.02, 1.0]
rotate = {angle}
rotate_axis = [0, 0, 1]
[body.ball]
shape = "sphere"
material = "basalt"
fixed = true
centre = [4.5, 2.0, 0.0]
radius = 0.6
[body.wedge]
shape = "box"
material = "basalt"
fixed = true
normal = [-1, 0, 0]
min = [0.5, 1.0, -1.0]
max = [1.5, 3.0, 1.0]
where = "= x - 1 - 0.5*z"
[body.drop]
shape = "sphere"
material = "water"
centre = [3.5, 3.5, 0.5]
radius = 0.15
"""


def bodies(folder, angle, names):
    """What the bodies of these names leave of cells of 0.1 m."""
    grid(folder / "terrain.asc", lambda x, y: 0 * x)
    path = folder / "case.toml"
    path.write_text(text(3, more=BODIES.format(angle=angle)))
    scenario = load_scenario(path)
    return remainder_of([body_of(scenario, name) for name in names], 3, 0.1)


@pytest.mark.parametrize(
    ("name", "angle", "volume"),
    [
        ("box", 0.0, 2.0 * 0.3),
        ("box", 33.0, 2.0 * 0.3),
        ("ball", 0.0, np.pi * (0.36 * 0.3 - 0.009)),
        ("wedge", 0.0, 2.0 * (0.5 * 0.3 + 0.25 * 0.09)),
    ],
)
def test_cells_are_cut_by_the_volume_of_bodies(tmp_path, name, angle, volume):
    """Three layers of cells below level ground lose what a box (also turned), a ball and a body
    that its `where` carves take up; what is left of a cell has its middle outside.
    """
    remainder = bodies(tmp_path, angle, [name])
    along = (np.arange(-10, 80) + 0.5) * 0.1
    x, y, z = np.meshgrid(along, along, [-0.05, -0.15, -0.25], indexing="ij")
    place = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    cells = np.concatenate([place, np.broadcast_to([0.0, 0.0, 1.0], place.shape)], axis=1)
    share, *middle = remainder(cells.ravel().tolist()).reshape(-1, 4).T
    assert (1 - share).sum() * 1e-3 == pytest.approx(volume, rel=0.01)
    cut = (share > 0) & (share < 1)
    assert cut.any()
    moved = np.column_stack(middle) - place
    assert np.abs(moved[share == 1]).max() < 1e-9
    assert np.abs(moved[cut]).max() < 0.05
    assert (np.linalg.norm(moved[cut], axis=1) > 0).any()
