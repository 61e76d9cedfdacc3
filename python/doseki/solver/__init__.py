"""From a scene to a simulation of the compiled core."""
