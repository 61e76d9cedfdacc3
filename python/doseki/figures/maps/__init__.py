"""Pictures of maps, and of what was along a path."""
