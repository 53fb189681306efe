"""Wavefronts of paths, the passes that shade them, and the film."""
