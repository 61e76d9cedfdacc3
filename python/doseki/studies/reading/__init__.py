"""What is read of each run: results, misfits to observations, and what bands are drawn of."""
