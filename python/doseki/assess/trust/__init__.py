"""How far a run can be trusted, judged afterwards from its record."""
