"""Intersection of rays with triangles: by Embree, or by a BVH in a shader."""
