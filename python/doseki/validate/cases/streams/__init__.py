"""Flows along walls: films, channels, other laws of viscosity."""
