// Volumes: grids of densities in boxes, which may be turned and sheared (viewer/raster/volume_textures.py). All grids
// are parts of one 3D texture.
uniform sampler3D u_densities;
uniform mat4 u_volume_box[VOLUMES];   // eye-relative space to the box [0, 1]^3
uniform vec3 u_volume_margin[VOLUMES]; // half a voxel: beyond the outermost centres the density is constant
uniform vec3 u_volume_size[VOLUMES];   // of the grid in the texture
uniform float u_volume_start[VOLUMES]; // z of the grid in the texture
uniform float u_volume_extinction;     // of density 1, per eye-relative unit

// The part (from, to) of a ray that lies in a box; from >= to where it misses
vec2 volume_span(int k, vec3 p, vec3 d) {
    vec3 origin = (u_volume_box[k] * vec4(p, 1.0)).xyz, direction = mat3(u_volume_box[k]) * d;
    direction = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
    vec3 a = -origin / direction, b = (1.0 - origin) / direction;
    vec3 low = min(a, b), high = max(a, b);
    return vec2(max(low.x, max(low.y, low.z)), min(high.x, min(high.y, high.z)));
}

// The extinction of a volume at a point in its box
float volume_extinction(int k, vec3 p) {
    vec3 at = clamp((u_volume_box[k] * vec4(p, 1.0)).xyz, u_volume_margin[k], 1.0 - u_volume_margin[k]);
    at = at * u_volume_size[k] + vec3(0.0, 0.0, u_volume_start[k]);
    return u_volume_extinction * textureLod(u_densities, at, 0.0).r;
}

float volumes_at(vec3 p) {
    float sum = 0.0;
    for (int k = 0; k < VOLUMES; ++k) {
        vec3 at = (u_volume_box[k] * vec4(p, 1.0)).xyz;
        if (min(at.x, min(at.y, at.z)) >= 0.0 && max(at.x, max(at.y, at.z)) <= 1.0) sum += volume_extinction(k, p);
    }
    return sum;
}

// The optical depth of all volumes from p to the distance `reach` along d, by `steps` steps in each
float volumes_depth_ahead(vec3 p, vec3 d, float reach, int steps) {
    float depth = 0.0;
    for (int k = 0; k < VOLUMES; ++k) {
        vec2 span = volume_span(k, p, d);
        span = vec2(max(span.x, 0.0), min(span.y, reach));
        float step = (span.y - span.x) / float(steps);
        if (step <= 0.0) continue;
        float sum = 0.0;
        for (int j = 0; j < steps; ++j) sum += volume_extinction(k, p + (span.x + (float(j) + 0.5) * step) * d);
        depth += sum * step;
    }
    return depth;
}
