"""Carrying out the runs of a study: their folders, their rows, and who runs them."""
