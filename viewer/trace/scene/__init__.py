"""The scene as the path tracer's shaders read it."""
