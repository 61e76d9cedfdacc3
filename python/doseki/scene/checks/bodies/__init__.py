"""Checks of bodies that are told apart by number, and of those that are held."""
