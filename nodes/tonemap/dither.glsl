// Dither of zero mean and at most one step of the output, so that a smooth ramp does not band after rounding.
// DITHER 0: none; 1: ordered, 8x8 Bayer matrix; 2: triangular noise, new every frame.

#if DITHER != 0
uniform float u_step;  // one step of the output's channels
#endif

#if DITHER == 1
// Bayer's matrix by interleaving bits (Bayer 1973): 0..63, each once in an 8x8 tile.
uint bayer(uvec2 texel) {
    uint value = 0u;
    for (uint bit = 0u; bit < 3u; ++bit) {
        uint x = texel.x >> bit & 1u;
        uint y = texel.y >> bit & 1u;
        value = value << 2 | (x ^ y) << 1 | y;
    }
    return value;
}
#endif

#if DITHER == 2
// Jarzynski and Olano 2020, "Hash Functions for GPU Rendering": pcg3d.
uvec3 pcg3d(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Three uniform numbers in [0, 1) from the upper 24 bits, which a float holds exactly.
vec3 uniform_noise(uvec3 key) {
    return vec3(pcg3d(key) >> 8u) * (1.0 / 16777216.0);
}
#endif

vec3 dithered(vec3 encoded, ivec2 texel) {
#if DITHER == 0
    return encoded;
#else
#if DITHER == 1
    vec3 noise = vec3((float(bayer(uvec2(texel) & 7u)) + 0.5) / 64.0 - 0.5);
#else
    uint key = frame.counts.x * 2u + frame.counts.y * 0x9e3779b9u;
    vec3 noise = uniform_noise(uvec3(texel, key)) - uniform_noise(uvec3(texel, key + 1u));
#endif
    // Shrinks to nothing at black and white: those stay exact, and clamping cannot shift the mean.
    vec3 room = min(vec3(u_step), min(encoded, 1.0 - encoded));
    return encoded + noise * room;
#endif
}
