// The outputs of layers.frag and curve_layers.frag beside the position, and what both need for them.
#if OUT_NORMAL
layout(location = OUT_NORMAL) out vec4 o_normal; // shading normal, world axes
#endif
#if OUT_IDS
layout(location = OUT_IDS) out vec4 o_ids;
uniform vec4 u_ids; // the instance from 1 and the material from 1, each as its lower 16 bits and the rest
#endif
#if OUT_ALBEDO
layout(location = OUT_ALBEDO) out vec4 o_albedo;
#endif
#if OUT_UV
layout(location = OUT_UV) out vec4 o_uv; // texture coordinates; motion in pixels, to the right and down
#endif
#if HAS_MOTION
uniform vec2 u_half_picture; // half of the picture in pixels
uniform float u_moves;       // 0 where camera and surface stand still: no rounding shows there

// From clip space at this time to that at the next. 0 for what is behind the camera then.
vec2 motion(vec4 here, vec4 next) {
    if (u_moves == 0.0 || next.w <= 0.0) return vec2(0.0);
    return (next.xy / next.w - here.xy / here.w) * u_half_picture * vec2(1.0, -1.0);
}
#endif
