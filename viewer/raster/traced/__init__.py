"""Passes of the raster that trace rays with the path tracer's intersector: reflections and refraction."""
