"""The cases: each module holds CASES and runs the scenario that lies beside it."""
