// Colour: Rec. 709 luminance, the sRGB transfer function (IEC 61966-2-1, the exact two pieces), and finiteness by bits.
#ifndef COLOUR_GLSL
#define COLOUR_GLSL

// Luminance of linear Rec. 709 primaries.
float luminance(vec3 linear) {
    return dot(linear, vec3(0.2126, 0.7152, 0.0722));
}

// Linear 0..1 -> sRGB-encoded 0..1.
vec3 srgb_encode(vec3 linear) {
    vec3 clamped = clamp(linear, 0.0, 1.0);
    vec3 curved = 1.055 * pow(clamped, vec3(1.0 / 2.4)) - 0.055;
    return mix(curved, clamped * 12.92, lessThanEqual(clamped, vec3(0.0031308)));
}

// sRGB-encoded 0..1 -> linear 0..1.
vec3 srgb_decode(vec3 encoded) {
    vec3 clamped = clamp(encoded, 0.0, 1.0);
    vec3 curved = pow((clamped + 0.055) / 1.055, vec3(2.4));
    return mix(curved, clamped / 12.92, lessThanEqual(clamped, vec3(0.04045)));
}

// Tested on the bits: a compiler that assumes finite arithmetic may fold isnan() and isinf() away.
bool is_finite(float value) {
    return (floatBitsToUint(value) & 0x7f800000u) != 0x7f800000u;
}

bool is_finite(vec3 value) {
    return is_finite(value.x) && is_finite(value.y) && is_finite(value.z);
}

bool is_nan(float value) {
    return (floatBitsToUint(value) & 0x7fffffffu) > 0x7f800000u;
}

// A radiance that arithmetic survives: NaN and negatives become 0, everything else is at most `ceiling`.
vec3 finite_radiance(vec3 radiance, float ceiling) {
    vec3 numbers = mix(radiance, vec3(0.0), bvec3(is_nan(radiance.x), is_nan(radiance.y), is_nan(radiance.z)));
    return clamp(numbers, 0.0, ceiling);
}

#endif
