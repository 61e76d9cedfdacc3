"""The surface of what flows: a level of its smoothed share of the space."""
