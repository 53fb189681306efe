// A picture with what photons have brought to it, which is additional: the mean over u_photons of them.
uniform sampler2D u_picture, u_photon_sum;
uniform float u_photons;

out vec4 o_radiance; // associated alpha

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    o_radiance = texelFetch(u_picture, pixel, 0)
               + vec4(texelFetch(u_photon_sum, pixel, 0).rgb / max(u_photons, 1.0), 0.0);
}
