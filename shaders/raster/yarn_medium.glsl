// A yarn as a medium: fibres spread evenly over its cross-section, or over that of a ply. They run about along the
// yarn, so that the optical depth of a way is that of its shadow on the cross-section.
uniform float u_tube;       // radius of the tube that is drawn, in radii of the yarn; 0 where fibres are
uniform vec2 u_yarn_depths; // optical depth on a radius of the yarn: in the yarn, in the tube

float tube_opacity(float across) {
    return 1.0 - exp(-u_yarn_depths.y * 2.0 * u_tube * sqrt(max(1.0 - across * across, 0.0)));
}
