"""A run as a scene of ParaView: what has a shape as polygons, and a state that shows it all."""
