"""Walls for the resolved scheme: where their surface is, for each of their particles."""
