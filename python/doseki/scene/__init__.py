"""From a scenario to arrays: bodies, lattices, packings, wall normals, inflow sections."""
