"""The report on a run: one HTML file that can be sent."""
