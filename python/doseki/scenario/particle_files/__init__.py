"""Particles read from files: CSV and HDF5."""
