"""The state of a checkpoint, looked at before the core sees it: whoever wrote it may mean harm."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from ..record.particles import BOUND, FIXED
from ..scenario.values.types import LARGEST
from .protocol import Arrays, CoreSimulation

# Arrays with one row for each of the same things; those of particles are named by the core.
ALIKE = (
    (
        "bodies", "body_shape", "body_material", "body_named", "body_fixed", "body_mass",
        "body_inertia", "rigid_origin_number", "rigid_origin_parent",
        "rigid_origin_born",
    ),
    ("shape_radius", "shape_facets", "shape_sample_count", "shape_kind", "shape_thickness"),
    ("lists_moving", "lists_fixed"),
    ("contact_a", "contact_b", "contact_springs", "contact_normals", "contact_vertex"),
    (
        "elastic_rest", "elastic_position", "elastic_velocity", "elastic_body", "elastic_clamped",
        "elastic_slot", "elastic_acceleration", "elastic_deformation",
        "deformable_face_normal", "deformable_face_area", "deformable_face_edge_normals",
        "deformable_face_depth", "deformable_face_face", "deformable_flow_force",
        "deformable_steady_force", "deformable_acceleration", "deformable_rigid_point",
        "elastic_gone", "elastic_held_shape",
    ),
    (
        "surface_point", "surface_offset", "surface_crease", "surface_radius", "surface_key",
        "surface_curve", "surface_outward", "surface_share",
    ),
    (
        "elastic_apart", "elastic_rigid", "elastic_held_energy", "deformable_material",
        "deformable_group", "deformable_unwetted", "deformable_origin_number",
        "deformable_origin_parent", "deformable_origin_born",
    ),
    (
        "breakable_rigid", "breakable_deformable", "breakable_centre", "breakable_orientation",
        "breakable_deforms_for", "breakable_loudness", "breakable_strength", "breakable_bears",
    ),
)  # fmt: skip
# An entry of a list: a particle, and in the upper bits through which image of it.
INDEX_BITS = 27
INDEX_MASK = 2**INDEX_BITS - 1
POSITIVE = {
    "mass", "smoothing_length", "density", "shape_radius", "body_mass", "elastic_stable_step",
}  # fmt: skip
NOT_NEGATIVE = {
    "wall_cut",
    "time", "last_timestep", "steps", "updates", "rebuilds", "rebuild_step", "moved", "skin",
    "skin_width", "next_timestep", "next_id", "inflow_released", "bodies_moved",
    "shape_thickness", "lanes", "approach", "lists_reach", "min_support", "moved_since_outflow",
    "surface_radius", "surface_share", "rigid_origin_born", "deformable_origin_born",
    "body_numbers", "breakable_deforms_for", "bodies_at_start", "through_ground",
}  # fmt: skip
PLACES = {
    "position", "lists_position", "elastic_position", "elastic_acted", "elastic_rest",
    "elastic_apart",
}  # m  # fmt: skip
BALL = 0  # the kind of a shape without sides
OF_METER = re.compile(r"\d+_(load|plane)_")  # arrays of a load meter, or of a plane that counts
FACES = {"face", "deformable_face_face"}  # numbers of faces, with a minus below the first row
MAX_FACES = 2**24  # that single precision tells apart
MAX_COUNT = 2**53  # no run counts so far; the core goes on counting from what it is given
# Infinite where nothing limits a step.
MAY_BE_INFINITE = {"next_timestep"}


def check_state(simulation: CoreSimulation, state: Arrays, materials: int, bodies: int) -> None:
    """Raise ValueError, which names an array, for a state that the simulation cannot have.

    `simulation` is empty: its own state tells which arrays there are, and of what type and shape.
    `materials` and `bodies` are the numbers of names that particles index.
    """
    expected = simulation.checkpoint()
    if missing := sorted(set(expected) - set(state)):
        raise ValueError(f"the checkpoint has no {missing[0]}")
    if unknown := sorted(set(state) - set(expected)):
        raise ValueError(f"the checkpoint has {unknown[0]}, which is not part of the state")
    for name in state:
        _check_form(name, state[name], expected[name])
    particles = simulation.particle_arrays
    for group in (particles, *ALIKE):
        _check_lengths(group, state)
    for name in ("stress_record", "lists_position"):
        if len(state.get(name, [])) not in (0, len(state["id"])):
            raise ValueError(f"the checkpoint's {name} has not one row for each particle")
    for name, values in state.items():
        _check_values(name, values)
    _check_indices(state, materials, bodies)
    _check_bodies(state)
    if state["lanes"][0] > 0:  # else several ranks wrote it, without lists
        _check_lists(state)


def with_new_meters(simulation: CoreSimulation, state: Arrays) -> dict[str, np.ndarray]:
    """A state of another run, with the meters that an empty simulation has: from zero."""
    other = {name: values for name, values in state.items() if not OF_METER.match(name)}
    own = {name: v for name, v in simulation.checkpoint().items() if OF_METER.match(name)}
    return other | own


def _check_form(name: str, values: np.ndarray, form: np.ndarray) -> None:
    """The type, and the shape of a row; what has one row in an empty state has one always."""
    one = len(form) == 1 and len(values) != 1
    if values.dtype != form.dtype or values.shape[1:] != form.shape[1:] or one:
        raise ValueError(
            f"the checkpoint's {name} is {values.dtype} {values.shape}, expected {form.dtype}, "
            f"rows of {form.shape[1:]}"
        )


def _check_lengths(group: tuple[str, ...] | list[str], state: Arrays) -> None:
    lengths = {name: len(state[name]) for name in group if name in state}
    if len(set(lengths.values())) > 1:
        longest = max(lengths, key=lambda name: lengths[name])
        shortest = min(lengths, key=lambda name: lengths[name])
        raise ValueError(
            f"the checkpoint's {shortest} has {lengths[shortest]} rows, but {longest} has "
            f"{lengths[longest]}"
        )


def _check_values(name: str, values: np.ndarray) -> None:
    """Finite numbers of the right sign, and places where one can be."""
    plain = re.sub(r"^\d+_", "", name)  # of one of several inflows
    if values.dtype.kind == "f":
        good = np.isfinite(values)
        if plain in MAY_BE_INFINITE:
            good |= values == np.inf
        if plain in PLACES:
            good &= np.abs(values) <= LARGEST
        _expect(good, name, "is not finite, or out of range")
    if values.dtype == np.int64:
        _expect((values >= -MAX_COUNT) & (values <= MAX_COUNT), name, "is out of range")
    if plain in FACES:
        _expect((values > -MAX_FACES) & (values < MAX_FACES), name, "is out of range")
    if plain in POSITIVE:
        _expect(values > 0, name, "is not above 0")
    if plain in NOT_NEGATIVE:
        _expect(values >= 0, name, "is below 0")


def _expect(good: np.ndarray, name: str, wrong: str) -> None:
    if not good.all():
        row = int(np.argwhere(~np.atleast_1d(good))[0][0])
        raise ValueError(f"the checkpoint's {name} {wrong} (row {row})")


def _check_indices(state: Arrays, materials: int, bodies: int) -> None:
    """Whatever numbers something else, numbers something that is there."""
    for name, count in _counts(state, materials, bodies).items():
        if name in state:
            found = state[name]
            _expect((found >= 0) & (found < count), name, f"is not from 0 to {count - 1}")
    identity = state["id"]
    if len(np.unique(identity)) < len(identity):
        raise ValueError("the checkpoint's id is not unique")
    _expect((identity >= 0) & (identity < state["next_id"][0]), "id", "is not below next_id")


def _check_lists(state: Arrays) -> None:
    """Neighbour lists of clusters of `lanes` particles: of as many as there are, and no others."""
    count, lanes = len(state["id"]), int(state["lanes"][0])
    entries = state["lists_entries"]
    listed = sum(int(state[name].sum(dtype=np.int64)) for name in ("lists_moving", "lists_fixed"))
    if len(state["lists_moving"]) != -(-count // lanes) or listed != len(entries):
        raise ValueError(
            "the checkpoint's lists_moving or lists_fixed is not that of its particles"
        )
    moving = int(state["moving_particles"][0])
    is_wall = np.isin(state["motion"], (FIXED, BOUND))
    if not np.array_equal(is_wall, np.arange(count) >= moving):
        raise ValueError("the checkpoint's moving_particles are not the first of its particles")
    # Of each list first the moving neighbours, then the fixed ones.
    parts = np.stack([state["lists_moving"], state["lists_fixed"]], axis=1).reshape(-1)
    of_moving = np.repeat(np.arange(len(parts)) % 2 == 0, parts)
    place = entries & INDEX_MASK
    good = (place < count) & ((place < moving) == of_moving)
    good &= entries >> INDEX_BITS < 3 ** state["position"].shape[1]
    _expect(good, "lists_entries", "is no such neighbour")


def _check_bodies(state: Arrays) -> None:
    """Shapes, points and contacts of bodies that move as a whole."""
    dim = state["position"].shape[1]
    for name, parts, size in (
        ("shape_facets", "shape_corners", dim),
        ("shape_sample_count", "shape_samples", 1),
    ):
        counts = state[name]
        _expect(counts >= 0, name, "is below 0")
        if size * int(counts.sum(dtype=np.int64)) != len(state[parts]):
            raise ValueError(f"the checkpoint's {name} is not that of its {parts}")
    points = state["body_points"]
    owner = points[:, 0]
    _expect((owner >= 0) & (owner < len(state["bodies"])), "body_points", "is of no body")
    _check_contacts(state)
    _check_origins(state)
    if "body_kind" not in state:  # of schemes without bodies
        return
    # By body_kind: none, a rigid one, a deformable one.
    rows = np.array([2**31, len(points), len(state["elastic_position"])])[state["body_kind"]]
    bound = (state["motion"] == BOUND) & (state["body_kind"] > 0)
    _expect(
        ~bound | ((state["point"] >= 0) & (state["point"] < rows)), "point", "is none of a body"
    )


def _check_origins(state: Arrays) -> None:
    """Bodies that the record follows have the numbers from 0 on, each once."""
    count = int(state["body_numbers"][0])
    kinds = ("rigid_origin", "deformable_origin")
    rigid, deformable = (state[f"{kind}_number"] for kind in kinds)
    own, first = state["breakable_deformable"], state["breakable_rigid"]
    _expect((first >= -1) & (first < len(rigid)), "breakable_rigid", "is no body")
    own, first = own[first >= 0], first[first >= 0]
    if not np.array_equal(deformable[own], rigid[first]):
        raise ValueError("the checkpoint's breakable_rigid are not those of its bodies")
    numbers = np.concatenate([rigid, np.delete(deformable, own)])
    if not np.array_equal(np.sort(numbers[numbers >= 0]), np.arange(count)):
        raise ValueError("the checkpoint's body_numbers are not those of its bodies")
    for kind in kinds:
        parent = state[f"{kind}_parent"]
        _expect((parent >= -1) & (parent < count), f"{kind}_parent", "is no body")


def _check_contacts(state: Arrays) -> None:
    """Pairs of contact points, or of one and the convex body number -1 - b."""
    kind, samples = (
        state[name][state["body_shape"]] for name in ("shape_kind", "shape_sample_count")
    )
    a, b = state["contact_a"], state["contact_b"]
    if len(state["surface_point"]):  # the core knows how many points such surfaces have
        _expect(a >= 0, "contact_a", "is no point of a body")
        return
    points = int(np.where(kind == BALL, 1, samples).sum())
    _expect((a >= 0) & (a < points), "contact_a", "is no point of a body")
    _expect((b >= -int((kind != BALL).sum())) & (b < points), "contact_b", "is no body")


def _counts(state: Arrays, materials: int, bodies: int) -> Mapping[str, int]:
    """How many there are of what each array numbers."""
    return {
        "material": materials,
        "body": bodies,
        "motion": 4,
        "body_kind": 3,
        "body_shape": len(state["shape_radius"]),
        "shape_kind": 5,
        "elastic_rigid": 3,
        "body_material": materials,
        "body_named": bodies,
        "elastic_body": len(state["elastic_apart"]),
        "breakable_deformable": len(state["elastic_apart"]),
        "elastic_slot": len(state["elastic_position"]),
        "surface_point": len(state["elastic_position"]),
        "deformable_material": materials,
        "deformable_group": bodies,
        "surface_at_rest": len(state["elastic_position"]),
        "moving_particles": len(state["id"]) + 1,
        **dict.fromkeys(("body_fixed", "elastic_clamped", "elastic_gone", "surface_crease"), 2),
    }
