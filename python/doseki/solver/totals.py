"""What a simulation sums over its particles, and has counted since its start."""

from __future__ import annotations

from typing import TypedDict


class Totals(TypedDict):
    """Sums over the particles; in 2-D per metre of thickness."""

    mass: float  # kg, of free particles; this and the rest in 2-D per metre
    momentum: list[float]  # kg m/s, dim numbers
    kinetic_energy: float  # J, with that of bodies
    bulk_energy: float  # J
    shear_energy: float  # J
    av_dissipation: float  # J, by the artificial viscosity since the start
    # What they have got since the start: from gravity, walls that do not move by themselves, inflow
    # layers and contacts; what of it the scheme departs from its sums over pairs by.
    impulse: list[float]  # kg m/s, of all outer forces
    gravity_work: float  # J
    wall_work: float  # J, of walls that have a velocity and of the layers behind inflows
    contact_work: float  # J, below 0 where contacts damp
    scheme_work: float  # J, by corrections and shifting
    relaxation_work: float  # J, of that by the relaxation of density
    # Of deformable bodies: what they hold, and what they lost since the start.
    elastic_energy: float  # J, of strain and springs
    fracture_work: float  # J, by cracks
    parting_work: float  # J, when parts came off
    damping_work: float  # J, by their dampers
    broken_bonds: int  # that bear no tension
    parts: int  # deformable bodies that came off others
    dust_grains: int  # rigid grains that came off
    momentum_entered: list[float]  # kg m/s
    momentum_left: list[float]  # kg m/s
    energy_entered: float  # J, kinetic
    energy_left: float  # J, kinetic, and elastic of deformable bodies
    mass_initial: float  # kg
    mass_asked: float  # kg, that inflows should have brought
    mass_entered: float  # kg
    mass_left: float  # kg
    mass_through_ground: float  # kg, of mass_left: what got through a terrain
    volume_entered: float  # m3; 2-D: m2
    volume_left: float  # the same
    # Of each plane that counts, since the start: what went through it, less what came back; mass
    # that came before it otherwise, less what left there.
    plane_mass: list[float]  # kg
    plane_volume: list[float]  # m3; 2-D: m2
    plane_supplied: list[float]  # kg
    count: list[int]  # free particles of each material
