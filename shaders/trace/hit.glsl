// A texel of the hit texture; viewer/trace/rays/intersect.py describes it.
const uint INSTANCE_MASK = (1u << KIND_SHIFT) - 1u;
const uint MISS = uint(NO_KIND) << KIND_SHIFT | INSTANCE_MASK;
const uint FREE = 1u << 31;

struct Hit {
    int instance;
    int triangle;     // within its mesh
    vec2 barycentric; // of vertices 1 and 2
};

Hit unpack_hit(uvec4 texel) {
    return Hit(int(texel.x & INSTANCE_MASK), int(texel.y), uintBitsToFloat(texel.zw));
}

// The kind of the surface that was hit, NO_KIND if the ray missed
int hit_kind(uvec4 texel) {
    return int(texel.x >> KIND_SHIFT & 7u);
}

// Whether the shadow ray of the same path is unoccluded
bool is_shadow_ray_free(uvec4 texel) {
    return (texel.x & FREE) != 0u;
}
