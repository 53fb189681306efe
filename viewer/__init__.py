"""Show 3D models physically based, from Python."""
