// How the G-buffer stores a surface. What a format can hold decides the packing, so reader and writer must be given the
// same NORMAL_CHANNELS and NORMAL_SIGNED; rendergraph/nodes/gbuffer/packing.py derives them from the format.
//
//   normal      world space. 2 channels: octahedral; 3 or more: xyz. Unsigned formats store 0.5 + 0.5 x.
//   base_color  linear rgb (an sRGB format encodes by itself); a unused
//   material    r perceptual roughness, g metallic, b occlusion, a 1 for unlit
//   emissive    linear rgb radiance
#ifndef PACKING_GLSL
#define PACKING_GLSL

#include <octahedral.glsl>

vec4 pack_normal(vec3 normal) {
#if NORMAL_CHANNELS == 2
    vec4 stored = vec4(octahedral_encode(normal), 0.0, 0.0);
#else
    vec4 stored = vec4(normal, 0.0);
#endif
#if NORMAL_SIGNED
    return stored;
#else
    return stored * 0.5 + 0.5;
#endif
}

vec3 unpack_normal(vec4 stored) {
#if !NORMAL_SIGNED
    stored = stored * 2.0 - 1.0;
#endif
#if NORMAL_CHANNELS == 2
    return octahedral_decode(stored.xy);
#else
    // A cleared texel of a signed format decodes to the zero vector.
    return stored.xyz * inversesqrt(max(dot(stored.xyz, stored.xyz), 1e-20));
#endif
}

vec4 pack_material(float roughness, float metallic, float occlusion, bool unlit) {
    return vec4(roughness, metallic, occlusion, unlit ? 1.0 : 0.0);
}

#endif
