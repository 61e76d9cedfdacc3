"""Gauges: of each kind its table, its columns and how it is read."""
