"""Why a run failed: forces on a particle, the cause, the remedy."""
