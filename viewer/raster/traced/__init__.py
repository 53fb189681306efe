"""What the raster asks the path tracer's rays for: reflections, refraction."""
