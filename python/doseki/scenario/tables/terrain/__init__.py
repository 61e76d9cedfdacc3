"""Tables of runs on a terrain."""
