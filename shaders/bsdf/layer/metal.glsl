// The metal: an interface with no layer below. glTF specifies metals only by f0, so Schlick's curve is used.
#include "bsdf/layer/interface.glsl"

vec3 metal_fresnel(Interface face, float mu) {
    return f_schlick(face.f0, face.f90, mu);
}
