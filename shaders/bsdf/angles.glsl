// The cosines of one reflection, which the microfacets' factors are functions of. ANISOTROPIC: the factors also depend
// on where the tangent lies, and have GGX alone for their distribution (viewer/plan/bsdf_switches.py).
#if ANISOTROPIC
#define ALPHA vec2 // along the tangent, across it
#else
#define ALPHA float
#endif

// Of the isotropic lobe that stands for an anisotropic one: the same D along the normal
float mean_alpha(ALPHA alpha) {
#if ANISOTROPIC
    return sqrt(alpha.x * alpha.y);
#else
    return alpha;
#endif
}

struct Angles {
    float NoV, NoL, NoH, VoH;
    float s2; // |n x h|^2
#if ANISOTROPIC
    vec3 wo, wi, h; // x the tangent, z the normal
#endif
};

// wo and wi in the frame of the tangent and the normal
Angles local_angles(vec3 wo, vec3 wi) {
    vec3 h = normalize(wo + wi);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
#if ANISOTROPIC
    return Angles(wo.z, wi.z, h.z, VoH, dot(h.xy, h.xy), wo, wi, h);
#else
    return Angles(wo.z, wi.z, h.z, VoH, dot(h.xy, h.xy));
#endif
}
