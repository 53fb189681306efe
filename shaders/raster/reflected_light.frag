// What the rays of reflection_rays.frag met: the light that leaves there, between the corners of the triangle.
uniform usampler2D u_hit;      // viewer/trace/intersect.py
uniform sampler2D u_direction; // w: 1 where there is a ray
uniform isampler2D u_first;    // for each instance, the first texel of its first triangle
uniform sampler2D u_light;     // three texels a triangle: radiance at the corner, a component of the face normal

out vec4 o_reflected; // radiance, and 1 where anything was met

const uint INSTANCE_MASK = 0x0fffffffu;

vec4 texel_of(int i) {
    int width = textureSize(u_light, 0).x;
    return texelFetch(u_light, ivec2(i % width, i / width), 0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 direction = texelFetch(u_direction, pixel, 0);
    o_reflected = vec4(0.0);
    if (direction.w == 0.0) return;
    uvec4 hit = texelFetch(u_hit, pixel, 0);
    uint instance = hit.x & INSTANCE_MASK;
    if (instance == INSTANCE_MASK) return;
    int width = textureSize(u_first, 0).x;
    int first = texelFetch(u_first, ivec2(int(instance) % width, int(instance) / width), 0).r + 3 * int(hit.y);
    vec4 a = texel_of(first), b = texel_of(first + 1), c = texel_of(first + 2);
    vec2 weights = uintBitsToFloat(hit.zw);
    vec3 radiance = a.rgb + weights.x * (b.rgb - a.rgb) + weights.y * (c.rgb - a.rgb);
    bool is_back = dot(direction.xyz, vec3(a.a, b.a, c.a)) > 0.0; // of two sides both are lit alike: no normal
    o_reflected = vec4(is_back ? vec3(0.0) : radiance, 1.0);
}
