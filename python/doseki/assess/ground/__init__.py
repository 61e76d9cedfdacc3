"""What a map means for a run: the ground that a flow comes over, and what it cannot fill."""
