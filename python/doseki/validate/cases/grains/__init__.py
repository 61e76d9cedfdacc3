"""Grains as bodies, dry and in water."""
