// The dielectric: an interface over the diffuse base.
#include "bsdf/layer/interface.glsl"

// The exact Fresnel curve of a dielectric, scaled to go from 0 along the normal to 1 at grazing angles
float exact_fresnel_weight(float mu, float ior) {
    float f0 = f0_from_eta(ior);
    return clamp((f_dielectric(mu, ior) - f0) / max(1.0 - f0, 1e-6), 0.0, 1.0);
}

// Fresnel reflectance of the facets, Schlick's curve from f0 to f90; if FRESNEL = 1, the exact one of ior
vec3 dielectric_fresnel(Interface face, float mu, float ior) {
#if FRESNEL == 1
    return mix(face.f0, face.f90, exact_fresnel_weight(mu, ior));
#else
    return f_schlick(face.f0, face.f90, mu);
#endif
}
