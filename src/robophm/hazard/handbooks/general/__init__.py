"""Rates that no handbook computes: a maker's or the user's own figure."""
