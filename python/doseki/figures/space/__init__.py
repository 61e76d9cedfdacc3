"""Pictures of what is in space: balls, surfaces and the ground as a camera sees them."""
