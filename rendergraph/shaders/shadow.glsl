// How much of the sun a point sees, from the cascaded shadow map.
//
//   SHADOW_TAPS    the filter is a box of SHADOW_TAPS x SHADOW_TAPS bilinear comparisons
//   SHADOW_LAYERS  layers of the map; a map of one layer is no array
#ifndef SHADOW_GLSL
#define SHADOW_GLSL

#include <cascades.glsl>
#include <depth.glsl>

#if SHADOW_LAYERS > 1
uniform sampler2DArrayShadow u_shadow_map;
#else
uniform sampler2DShadow u_shadow_map;
#endif

float compare_depth(vec2 uv, uint cascade, float depth) {
#if SHADOW_LAYERS > 1
    return texture(u_shadow_map, vec4(uv, float(cascade), depth));
#else
    return texture(u_shadow_map, vec3(uv, depth));
#endif
}

// 0 in shadow .. 1 lit, at a world-space position with a unit normal. Lit beyond the last cascade.
float sun_visibility(vec3 position, vec3 normal) {
    if (cascades.count == 0u) {
        return 1.0;
    }
    float distance = view_depth(position);
    uint cascade = 0u;
    while (cascade + 1u < cascades.count && distance > cascades.far[cascade]) {
        ++cascade;
    }
    float end = cascades.far[cascades.count - 1u];
    if (distance >= end) {
        return 1.0;
    }
    // A filter of radius R sees depths that differ by R tan(angle) on a lit plane; moving the receiver out by
    // R sin(angle) along its normal clears exactly that.
    float cosine = clamp(dot(normal, frame.sun_direction.xyz), 0.0, 1.0);
    float radius = cascades.texel[cascade] * (0.5 * float(SHADOW_TAPS) + 0.5);
    position += normal * (cascades.normal_bias * radius * sqrt(1.0 - cosine * cosine));

    vec3 clip = (cascades.to_clip[cascade] * vec4(position, 1.0)).xyz;
    vec2 uv = clip.xy * 0.5 + 0.5;
    float texel = 1.0 / float(textureSize(u_shadow_map, 0).x);
    float lit = 0.0;
    for (int i = 0; i < SHADOW_TAPS * SHADOW_TAPS; ++i) {
        vec2 tap = vec2(i % SHADOW_TAPS, i / SHADOW_TAPS) - 0.5 * float(SHADOW_TAPS - 1);
        lit += compare_depth(uv + tap * texel, cascade, clip.z);
    }
    lit /= float(SHADOW_TAPS * SHADOW_TAPS);
    return mix(lit, 1.0, smoothstep(0.9, 1.0, distance / end)); // no line where shadows end
}

#endif
