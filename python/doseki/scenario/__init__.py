"""From a TOML file to a checked description of a run."""
