"""Pictures of many runs: parallel coordinates, responses, bands."""
