"""Precomputation for shading: prefiltered environments, irradiance, suns, DFG tables. It uses numpy, not OpenGL."""
