"""Checks of the tables of a scenario against one another."""
