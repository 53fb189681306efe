"""Where rays meet triangles: Embree, or a BVH in a shader."""
