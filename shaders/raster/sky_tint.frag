// The optical depth of what lets light through, seen from a light of the environment. Blending adds those of all
// surfaces: -log of what each of them passes on, which a thin wall does once and a solid at either face, and in a
// solid sigma_t d, as the difference of the depths of its faces. Light is taken to go straight on.
#include "material/uniforms.glsl"
#if ALPHA_MODE == 1
#include "raster/alpha_mask.glsl"
#endif
#include "raster/straight_through.glsl"

in vec3 v_position;       // in scene units
uniform vec4 u_light;     // xyz: the direction of the light
uniform vec3 u_center;    // of the instance: half floats hold depths from there
uniform vec3 u_absorption; // sigma_t, per scene unit
uniform float u_front;    // 1 if front faces show the light their outside, else -1
out vec4 o_tint;          // rgb: optical depth; a: depth, of which blending keeps the least

const float LEAST = 1e-3; // of what a surface passes on, within the range of half floats

void main() {
    MaterialInputs m = read_inputs();
#if ALPHA_MODE == 1
    if (mask_coverage(m.base_color.a) < 1.0) discard;
#endif
    vec3 n = cross(dFdx(v_position), dFdy(v_position));
    float mu = min(abs(dot(n, u_light.xyz)) / max(length(n), 1e-30), 1.0);
    vec3 passed = straight_through(m, mu) * m.base_color.rgb;
#if ALPHA_MODE == 2
    passed = mix(vec3(1.0), passed, m.base_color.a);
#endif
    o_tint = vec4(-log(max(passed, LEAST)), gl_FragCoord.z);
#if IS_SOLID
    float side = gl_FrontFacing ? -u_front : u_front;
    o_tint.rgb = 0.5 * o_tint.rgb + side * u_absorption * dot(v_position - u_center, u_light.xyz);
#endif
}
