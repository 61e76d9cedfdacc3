"""Running a scenario, and going on with a run."""
