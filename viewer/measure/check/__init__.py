"""Checks of the shaders: energy, sampling, stability."""
