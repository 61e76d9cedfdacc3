"""What Python calls on a simulation, whether it runs in one process or on many ranks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypedDict

import numpy as np
from numpy.typing import NDArray

from .totals import Totals

Floats = NDArray[np.float64]
Columns = dict[str, np.ndarray]  # arrays of one length by name
Arrays = Mapping[str, np.ndarray]  # the same as an argument
Table = Mapping[str, object]  # an argument whose keys and values the core checks
# Kind, id of the particle to blame and its position, m; -1 and empty where it is none.
CoreFailure = tuple[str, int, Sequence[float]]


class Rates(TypedDict):
    """Rates of change of the particles, in the order of their ids."""

    acceleration: Floats  # (N, dim) m/s2
    density_rate: Floats  # (N,) kg/m3/s
    deviatoric_stress_rate: Floats  # (N, 3, 3) Pa/s
    balsara: Floats  # (N,) the switch of the artificial viscosity; 0 in the resolved scheme
    timestep: float  # s, that the next step may take
    av_power: float  # W, dissipated by the artificial viscosity; 2-D: W/m


class Grains(TypedDict):
    """The rigid bodies, in the order in which they were added."""

    centre: Floats  # (n, dim) m
    velocity: Floats  # (n, dim) m/s
    spin: Floats  # (n, 3) rad/s
    orientation: Floats  # (n, 4) quaternions w, x, y, z
    flow_force: Floats  # (n, dim) N; 2-D: N/m
    contact_force: Floats  # (n, dim) N, mean over the last step; 2-D: N/m
    flow_impulse: Floats  # (n, dim) N s, since the start; 2-D: N s/m
    contact_impulse: Floats  # the same
    mass: Floats  # (n,) kg; 2-D: kg/m
    radius: Floats  # (n,) m, of the circumscribed ball
    contacts: NDArray[np.int32]  # (n,) bodies that it touches
    overlap: Floats  # (n,) largest, over the diameter
    body: NDArray[np.int32]  # (n,) index of the named body
    material: NDArray[np.int32]  # (n,)
    fixed: NDArray[np.bool_]  # (n,)
    removed: NDArray[np.bool_]  # (n,) has left the run
    number: NDArray[np.int32]  # (n,) stays with a body; -1: of one that is not followed
    parent: NDArray[np.int32]  # (n,) number of the body it was part of; -1: of none
    born: Floats  # (n,) time, s
    # Of any contact of rigid bodies that are no dust, since the start, over the diameter.
    worst_overlap: float


class Fragments(TypedDict):
    """Deformable bodies that may break, and their parts; see Grains for the columns."""

    centre: Floats
    velocity: Floats
    spin: Floats  # that gives the angular momentum to a rigid body of this shape
    orientation: Floats
    mass: Floats
    radius: Floats
    contacts: NDArray[np.int32]
    overlap: Floats
    body: NDArray[np.int32]
    material: NDArray[np.int32]
    removed: NDArray[np.bool_]
    number: NDArray[np.int32]
    parent: NDArray[np.int32]
    born: Floats


class Loads(TypedDict):
    """What n load meters have summed since the start; in 2-D per metre of thickness."""

    flow_impulse: Floats  # (n, dim) N s, of the flow
    contact_impulse: Floats  # (n, dim) N s, of contacts with bodies
    flow_turning: Floats  # (n, 3) N m s, about the point of the meter
    contact_turning: Floats  # the same of contacts
    peak_force: Floats  # (n, dim) N, mean over the step in which it was largest
    peak_moment: Floats  # (n, 3) N m, of that step
    peak_time: Floats  # (n,) s, when that step ended; -1: there was none yet
    hit_speed: Floats  # (n,) m/s, at which the body came that hit hardest; 0: none
    hit_radius: Floats  # (n,) m, of its circumscribed ball
    panels: NDArray[np.int64]  # (n,) how many each has
    panel_flow: Floats  # (all panels,) N s, normal to the panel; pressing is positive
    panel_contact: Floats  # the same of contacts


class ForceTerms(TypedDict):
    """What acts on one particle; both empty for one that does not move freely."""

    acceleration: dict[str, Floats]  # (dim,) m/s2 by term; they add up to the acceleration
    timestep: dict[str, float]  # s by condition; the particle allows the smallest


class SimulationView(Protocol):
    """A simulation at one moment."""

    def __len__(self) -> int:
        """Number of particles."""
        ...

    @property
    def bytes_per_particle(self) -> float:
        """Memory of state, records and lists."""
        ...

    def state(self) -> Columns:
        """Fields of the particles in the order of their ids; record.fields lists them."""
        ...

    def rates(self) -> Rates:
        """Rates of change as the last step left them."""
        ...


class Simulation(SimulationView, Protocol):
    """A simulation that has its particles; on several ranks, all call each method together."""

    @property
    def time(self) -> float:
        """Simulated time, s."""
        ...

    @property
    def timestep(self) -> float:
        """That of the last step, s."""
        ...

    @property
    def steps(self) -> int:
        """Steps done."""
        ...

    @property
    def rebuilds(self) -> int:
        """How often neighbour lists were built."""
        ...

    @property
    def updates(self) -> int:
        """Particles stepped, summed over the steps."""
        ...

    @property
    def skin(self) -> float:
        """Margin of the neighbour lists over the smallest support radius, as a fraction of it."""
        ...

    @property
    def entries_per_particle(self) -> float:
        """Entries of the neighbour lists."""
        ...

    @property
    def has_bodies(self) -> bool:
        """Whether bodies move on their own."""
        ...

    @property
    def failure(self) -> CoreFailure:
        """Why the last call failed; its kind is "" where it did not."""
        ...

    def start(self) -> None:
        """Build lists and take the first rates; call once.

        Raises the core's PhysicsFailure, as advance does.
        """
        ...

    def advance(self, limit: float, pause: float, max_steps: int) -> None:
        """Step until `limit`, s, which is met exactly, or return early at the first step at or
        past `pause`, s, or after `max_steps` steps.
        """
        ...

    def sample(self, low: Sequence[float], high: Sequence[float]) -> Columns:
        """What gauges read of the particles in a box, m, in the order of their ids."""
        ...

    def grains(self) -> Grains:
        """The rigid bodies."""
        ...

    def fragments(self) -> Fragments:
        """The deformable bodies that may break, and their parts."""
        ...

    def totals(self) -> Totals:
        """Sums over the particles."""
        ...

    def loads(self) -> Loads:
        """What the load meters have summed, in the order of adding."""
        ...

    def forget_load_peak(self, meter: int) -> None:
        """Peak and hit of a load meter are those from now on."""
        ...

    def force_terms(self, particle: int) -> ForceTerms:
        """Terms of the momentum equation of the particle of this id, Eqs. (12) or (27), and the
        conditions on its timestep, Eqs. (18) or (41), as last evaluated.
        """
        ...

    def neighbour_counts(self) -> Columns:
        """`id` of the particles in order, and `count` of others within support of each."""
        ...

    def checkpoint(self) -> Columns:
        """The whole state as arrays in storage order; on several ranks the part of this one."""
        ...

    def restore(self, arrays: Arrays) -> bool:
        """Go on from what checkpoint() gave; false where that changes the order of sums.

        Raises ValueError for the state of another simulation.
        """
        ...

    def time_phases(self, on: bool) -> None:
        """Start timing the phases of steps from zero, or stop."""
        ...

    def phase_seconds(self) -> dict[str, float]:
        """Wall time of each phase of a step since time_phases(True), s."""
        ...

    def interacting_pairs(self) -> float:
        """Ordered pairs of different particles within support; fixed-fixed ones not counted."""
        ...

    def bare_pair_rate(self, seconds: float) -> float:
        """Such pairs per second of one thread over clusters that stay in cache, timed for about
        `seconds` s.  Raises ValueError where the scheme has none.
        """
        ...


class CoreSimulation(Simulation, Protocol):
    """A simulation of the compiled core, to be filled and started."""

    def add_particles(
        self,
        *,
        position: Floats,
        velocity: Floats,
        mass: Floats,
        density: Floats,
        smoothing_length: Floats,
        material: NDArray[np.int32],
        body: NDArray[np.int32],
        motion: NDArray[np.int32],
        id: NDArray[np.int64],  # noqa: A002 (the name of the field)
    ) -> None:
        """Add particles; see record.particles.ParticleSet.  Raises ValueError for arrays of
        unequal length.
        """
        ...

    def set_walls(self, *, normal: Floats, depth: Floats, curvature: Floats) -> None:
        """Of wall particles: normals (N, dim) into the fluid, depths (N,) below the surface, m,
        and its curvature (N,), 1/m, as that of a ball; 0 where it is plane.
        """
        ...

    def set_edges(self, *, normals: Floats, depths: Floats) -> None:
        """Of wall particles beside edges: normals (N, dim*dim), one after the other, of the
        nearest faces, and depths (N, dim) below them, m; zero elsewhere.  After set_walls and
        before bind_points.
        """
        ...

    def set_faces(self, *, face: NDArray[np.int32], area: Floats) -> None:
        """Faces (N,) between which water stands and their areas (N, dim), m2 (2-D: m).

        After set_walls and before bind_points.
        """
        ...

    def add_shapes(self, shapes: Sequence[Table]) -> None:
        """Balls {radius}, convex shapes {vertices, faces, samples}, or meshes {..., thickness}."""
        ...

    def add_rigid_bodies(self, bodies: Arrays) -> None:
        """Rigid bodies that name a shape by its index."""
        ...

    def bind_points(self, body: NDArray[np.int32]) -> None:
        """Index of its rigid body for each particle, or -1; after set_walls."""
        ...

    def add_elastic_body(self, body: Table) -> None:
        """A deformable body of particles that were added; after set_walls."""
        ...

    def add_inflow(self, inflow: Table) -> None:
        """A section through which particles enter."""
        ...

    def add_outflow(self, low: Sequence[float], high: Sequence[float]) -> None:
        """A box, m, in which particles leave."""
        ...

    def add_plane(self, point: Sequence[float], normal: Sequence[float]) -> None:
        """A plane through a point, m, at which is counted what goes along its normal."""
        ...

    def move_body(self, motion: Table) -> None:
        """A prescribed motion of a fixed body."""
        ...

    def set_terrain(self, field: Table, wall: Table) -> None:
        """The bed as a surface, and what its wall particles are like; before the run starts."""
        ...

    def share_terrain(self, source: Callable[[list[float]], Floats]) -> None:
        """Hold only the part of the terrain that this rank needs.

        `source` gives parts: it is called on all ranks together, with the first node along each
        axis and how many (0: none), and gives heights, m, and then 1 for each unknown node.
        """
        ...

    def make_room_in_terrain(self, remainder: Callable[[list[float]], Floats]) -> None:
        """Have wall particles of the terrain only where bodies that stand in it have none.

        `remainder` is called with a place in the ground, m, and the normal there, for one cell
        after another, and gives what no body takes up of each: its share and its middle, m.
        """
        ...

    def add_load_meter(self, meter: Table) -> None:
        """Sum what acts on fixed bodies (their indices) about a point; with `count` on panels."""
        ...

    def set_stresses(self, deviatoric_stress: Floats) -> None:
        """Deviatoric stresses (N, 3, 3), Pa, of all particles, where the scheme evolves them."""
        ...

    def begin_at(self, time: float) -> None:
        """Set the clock, s, of a run that goes on from another one; after the inflows."""
        ...

    def join(self, transport: object) -> None:
        """Become one of several ranks, which a parallel.transport.Transport joins."""
        ...

    def restore_shared(self, arrays: Arrays) -> None:
        """restore() of a state that all ranks have read and that is to be divided among them."""
        ...

    def shares(self) -> dict[str, float]:
        """What this rank has spent on balance, migrate, halo, wait, in `total` and of that `busy`
        with its own steps, s; bytes_sent and messages_sent; its particles and ghosts.
        """
        ...

    @property
    def particle_arrays(self) -> list[str]:
        """Names of the arrays of a checkpoint that have one row for each particle."""
        ...
