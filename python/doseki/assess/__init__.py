"""What a run will take, what is doubtful about it, and how far its result can be trusted."""
