"""Periodic flows without walls: sound, shear, vortices."""
