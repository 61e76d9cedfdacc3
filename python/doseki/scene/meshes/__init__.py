"""Fixed surfaces of triangles: from their files to wall particles and what bodies touch."""
