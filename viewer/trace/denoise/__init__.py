"""Denoisers of path-traced pictures."""
