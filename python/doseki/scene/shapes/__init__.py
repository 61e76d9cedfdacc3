"""Shapes of bodies in their own frame, about their centre of mass: geometry and particles.

Discs and spheres (Ball), convex polygons and polyhedra (Convex), fixed meshes (MeshShape).
Lengths in m.  What a shape gives (particles, shares, normals, points of contact) has the symmetries
of the shape and turns with it.
"""

from .ball import Ball
from .convex import Convex
from .making import ShapeError, box_shape, mesh_shape, polygon_shape
from .mesh import MeshShape, Triangles, core_mesh
from .particles import EDGE, Edges, Particles, beside_edges, nearest_faces, no_edges
from .plane_faces import PlaneFaces

Shape = Ball | Convex | MeshShape

__all__ = [
    "EDGE",
    "Ball",
    "Convex",
    "Edges",
    "MeshShape",
    "Particles",
    "PlaneFaces",
    "Shape",
    "ShapeError",
    "Triangles",
    "beside_edges",
    "box_shape",
    "core_mesh",
    "mesh_shape",
    "nearest_faces",
    "no_edges",
    "polygon_shape",
]
