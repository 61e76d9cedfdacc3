"""From numbers to pictures and films."""
