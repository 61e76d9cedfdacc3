"""Gauges for the design of structures: loads, pressures on panels, sections, overtopping."""
