"""The tables of a scenario file: keys, types, units and bounds, each declared once."""
