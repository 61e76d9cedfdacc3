"""Masses that slide on beds with friction."""
