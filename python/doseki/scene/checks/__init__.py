"""Checks of what a scene is made of, and warnings about it."""
