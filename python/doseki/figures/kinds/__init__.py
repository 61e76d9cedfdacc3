"""Figures that a scenario requests: one file for each kind of [figure.NAME]."""
