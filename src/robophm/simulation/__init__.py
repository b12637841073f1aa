"""Robots that really fail: the truth that predictions are scored against. Shares only file formats with the engine."""
