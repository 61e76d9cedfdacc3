"""Values in a scenario file: expressions, units, bounds, and where in the text they stand."""
