// The dielectric: an interface over the diffuse base.
#include "bsdf/layer/interface.glsl"

// Fresnel reflectance of the facets. FRESNEL = 1 (exact) replaces Schlick's curve from f0 to f90 by the exact one of
// ior, scaled to the same ends.
vec3 dielectric_fresnel(Interface face, float mu, float ior) {
#if FRESNEL == 1
    float f0 = (ior - 1.0) / (ior + 1.0);
    f0 *= f0;
    float exact = f_dielectric(mu, ior);
    return mix(face.f0, face.f90, clamp((exact - f0) / max(1.0 - f0, 1e-6), 0.0, 1.0));
#else
    return f_schlick(face.f0, face.f90, mu);
#endif
}
