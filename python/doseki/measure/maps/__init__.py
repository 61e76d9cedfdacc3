"""Maps of a flow on the grid of a terrain: largest depth, speed and pressure, arrival, deposit."""
