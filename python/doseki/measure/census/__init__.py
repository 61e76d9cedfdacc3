"""The census of grains: which of them wait, float, roll or lie, and where the water is."""
