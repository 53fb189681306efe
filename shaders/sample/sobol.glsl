// Four dimensions of the Sobol sequence, shuffled and Owen-scrambled by hashes: Burley 2020, "Practical Hash-based Owen
// Scrambling". Each seed gives another sequence. For every k its first 2^k points are stratified.
// Fractions are stored with mirrored bits (the lowest bit is 1/2), so that the steps need not mirror them.

// Wellons 2018, "Prospecting for Hash Functions" (lowbias32)
uint hash(uint x) {
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

uint hash(uint a, uint b) {
    return hash(hash(a) + b);
}

uint hash(uint a, uint b, uint c) {
    return hash(hash(a, b) + c);
}

uvec4 mirror_bits(uvec4 x) {
    x = (x << 16u) | (x >> 16u);
    x = ((x & 0x00FF00FFu) << 8u) | ((x >> 8u) & 0x00FF00FFu);
    x = ((x & 0x0F0F0F0Fu) << 4u) | ((x >> 4u) & 0x0F0F0F0Fu);
    x = ((x & 0x33333333u) << 2u) | ((x >> 2u) & 0x33333333u);
    return ((x & 0x55555555u) << 1u) | ((x >> 1u) & 0x55555555u);
}

// Owen scrambling of mirrored fractions: each bit is flipped by a hash of only the bits below it. Laine & Karras 2011,
// "Stratified Sampling for Stochastic Transparency"; constants by Vegdahl 2021, "Building a Better LK Hash".
uvec4 owen_scramble(uvec4 x, uvec4 seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

// Point `index` < 2^24 of dimensions 1 to 4, as mirrored fractions, with the primitive polynomials p and initial
// numbers of Joe & Kuo 2008. The direction numbers v satisfy the recurrence p(v) = 0. So they also satisfy p^(2^k)(v) =
// 0, the same recurrence with 2^k times the stride. One step with it moves a whole block of the index's bits to lower
// bits; the bits that it would shift by the polynomial's degree stay in place. So 24 bits need log2(24) steps and no
// table.
uvec4 sobol(uint index) {
    uint x = index; // 1 + x: v[j] = v[j-1] + v[j-1] >> 1
    x ^= (x & 0xFFFF0000u) >> 16u;
    x ^= (x & 0xFF00FF00u) >> 8u;
    x ^= (x & 0xF0F0F0F0u) >> 4u;
    x ^= (x & 0xCCCCCCCCu) >> 2u;
    x ^= (x & 0xAAAAAAAAu) >> 1u;

    uint y = index; // 1 + y + y^2: v[j] = v[j-1] + v[j-2] + v[j-2] >> 2
    y ^= (y & 0xFF000000u) >> 8u;
    y ^= ((y & 0xFFFF0000u) >> 16u) ^ ((y & 0x00FF0000u) >> 8u);
    y ^= (y & 0xF000F000u) >> 4u;
    y ^= ((y & 0xFF00FF00u) >> 8u) ^ ((y & 0x0F000F00u) >> 4u);
    y ^= (y & 0xC0C0C0C0u) >> 2u;
    y ^= ((y & 0xF0F0F0F0u) >> 4u) ^ ((y & 0x30303030u) >> 2u);
    y ^= (y & 0x88888888u) >> 1u;
    y ^= ((y & 0xCCCCCCCCu) >> 2u) ^ ((y & 0x44444444u) >> 1u);
    y ^= (y & 0xAAAAAAAAu) >> 1u;

    uint z = index; // 1 + z + z^3: v[j] = v[j-2] + v[j-3] + v[j-3] >> 3
    z ^= (z & 0xF00000u) >> 8u;
    z ^= ((z & 0xFFF000u) >> 12u) ^ ((z & 0x0FF000u) >> 8u);
    z ^= (z & 0xC00C00u) >> 4u;
    z ^= ((z & 0xFC0FC0u) >> 6u) ^ ((z & 0x3C03C0u) >> 4u);
    z ^= (z & 0x820820u) >> 2u;
    z ^= ((z & 0xE38E38u) >> 3u) ^ ((z & 0x618618u) >> 2u);
    z ^= (z & 0x492492u) >> 1u;
    return uvec4(index, x, y, z);
}

vec4 sobol_owen(uint index, uint seed) {
    uint shuffled = mirror_bits(owen_scramble(mirror_bits(uvec4(index)), uvec4(hash(seed)))).x;
    uvec4 seeds = uvec4(hash(seed, 1u), hash(seed, 2u), hash(seed, 3u), hash(seed, 4u));
    return vec4(mirror_bits(owen_scramble(sobol(shuffled), seeds)) >> 8u) * exp2(-24.0);
}
