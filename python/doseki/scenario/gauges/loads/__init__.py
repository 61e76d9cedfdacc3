"""Gauges for the design of structures: loads, pressures on panels, the flow that comes, overtopping."""
