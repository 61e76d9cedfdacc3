"""Areas of faces on which films of water press."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.scene.contact_faces import FIRST_BODY, contact_faces
from doseki.validate.running import CASES


@pytest.mark.parametrize(("dim", "across"), [(2, 5), (2, 6), (2, 12), (3, 5), (3, 6)])
def test_two_rows_of_a_face_have_all_of_its_area(dim, across):
    """Below them there is next to none, and faces of a closed body add up to nothing."""
    block = str(CASES / "grains" / "block-under-water.toml")
    scenario = load_scenario(block, [f"across={across}", f"dim={dim}"])
    scene = build_scene(scenario)
    bodies, particles = scene.bodies, scene.particles
    faces = contact_faces(scenario, particles, bodies, bodies.depth, bodies.normal)
    member, row = bodies.grain == 0, np.floor(bodies.depth / scenario.dp)
    assert np.all(faces.face[member & (row == 0)] == FIRST_BODY)
    assert np.all(faces.face[member & (row == 1)] == -FIRST_BODY)
    assert not faces.face[member & (row > 1)].any()
    lower = member & (particles.position[:, -1] < (0.5 * across - 0.25) * scenario.dp)
    in_rows = faces.area[lower & (faces.face != 0)].sum(axis=0)
    assert in_rows == pytest.approx(faces.area[lower].sum(axis=0), abs=1e-9)
    assert in_rows[-1] < -0.8 * (across * scenario.dp) ** (dim - 1)
    assert np.abs(faces.area[member].sum(axis=0)).max() < 1e-12
