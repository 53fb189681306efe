// The thickness of a film by a map: mix(minimum, maximum, texel.g), KHR_materials_iridescence. Without a map it is the
// maximum, which is the only one that is read later on.
#include "material/inputs.glsl"

void apply_iridescence_thickness(inout MaterialInputs m, vec4 texel) {
    m.iridescence_thickness_maximum = mix(m.iridescence_thickness_minimum, m.iridescence_thickness_maximum, texel.g);
}
