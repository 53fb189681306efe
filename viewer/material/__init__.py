"""Derived from the material declaration: which maps are used, and uniforms, records and GLSL for the shaders."""
