"""Walls that several fixed bodies make together."""
