"""What the interactive view of a report holds: numbers small enough for a file that is sent."""
