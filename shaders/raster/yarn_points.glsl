// Points of what a yarn is shown as: its tube, its plies, or their fibres (Zhao and others 2016; Wu and Yuksel 2017).
// viewer/scene/yarn/fibres.py has the same, and says what the numbers are.
uniform sampler2D u_axis;   // four texels a point: place, radius, negative at a yarn's end; normal, angle of the first
                            // ply; binormal, angle of fibres about their ply; how far fibres have migrated, number of
                            // the yarn
uniform sampler2D u_fibres; // one texel for each fibre of each yarn
uniform ivec4 u_shown;      // the first point; the strands of a yarn; 0 for tubes, 1 for plies, 2 for fibres; fibres a
                            // ply
uniform vec4 u_plies;       // how many; their distance from the axis, radius and half width, in radii of the yarn
uniform vec2 u_spun;        // radius of a fibre, lowest share of R

int g_strand;

vec4 axis_texel(int row, int k) {
    int at = 4 * row + k;
    return texelFetch(u_axis, ivec2(at & (POINTS_WIDTH - 1), at / POINTS_WIDTH), 0);
}

vec4 point(int row) {
    vec4 axis = axis_texel(row, 0);
    if (u_shown.z == 0) return axis;
    vec4 normal = axis_texel(row, 1), binormal = axis_texel(row, 2);
    int ply = g_strand;
    float outwards = u_plies.y, around = 0.0, radius = u_plies.z;
    if (u_shown.z == 2) {
        vec2 more = axis_texel(row, 3).xy;
        int at = int(more.y) * u_shown.y + g_strand;
        vec4 fibre = texelFetch(u_fibres, ivec2(at & (POINTS_WIDTH - 1), at / POINTS_WIDTH), 0);
        float r = 0.5 * fibre.x * (fibre.w + u_spun.y + (fibre.w - u_spun.y) * cos(more.x + fibre.z));
        float phi = binormal.w + fibre.y;
        outwards += u_plies.z * r * cos(phi);
        around = u_plies.w * r * sin(phi);
        radius = u_spun.x;
        ply /= u_shown.w;
    }
    float angle = normal.w + 6.28318531 * float(ply) / u_plies.x;
    vec2 along = vec2(cos(angle), sin(angle));
    vec2 at = abs(axis.w) * (outwards * along + around * vec2(-along.y, along.x));
    return vec4(axis.xyz + at.x * normal.xyz + at.y * binormal.xyz, axis.w * radius);
}
