"""Gauges for the design of structures: loads, panels, the flow that comes, overtopping."""
