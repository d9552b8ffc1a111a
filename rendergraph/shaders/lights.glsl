// Local lights. Layout mirrored by rendergraph/scene/gpu_layout.py.
//
//   SPOT_LIGHTS     0: all are points, and cones are not compiled
//   UNIFORM_LIGHTS  how many lights a uniform block holds; 0: they lie in a storage block
#ifndef LIGHTS_GLSL
#define LIGHTS_GLSL

#ifndef SPOT_LIGHTS
#define SPOT_LIGHTS 1
#endif
#ifndef UNIFORM_LIGHTS
#define UNIFORM_LIGHTS 0
#endif

// 64 bytes
struct Light {
    vec4 position_radius;  // xyz world [m], w reach [m]: exactly dark at and beyond it
    vec4 intensity;        // rgb radiant intensity, w minimum distance d0 [m]
    vec4 axis_outer;       // spot: xyz unit axis (the way the light travels), w cos(outer half angle); points: w = -2
    vec4 inner;            // x cos(inner half angle), yzw unused
};

// All invocations read one light at a time, which is what uniform blocks are made for. llvmpipe walks through the lanes of
// a storage block's load one by one: with 16 lights that was a quarter of the lighting pass.
#if UNIFORM_LIGHTS
layout(std140) uniform Lights { Light lights[UNIFORM_LIGHTS]; };
#else
layout(std430) readonly buffer Lights { Light lights[]; };
#endif

// Irradiance per intensity [1/m^2] at squared distance `distance2`: inverse square, windowed to be exactly zero at and
// beyond `radius` (Karis, "Real shading in Unreal Engine 4", 2013), and bounded by 1 / d0^2 at the light itself.
float distance_attenuation(float distance2, float radius, float d0) {
    float radius2 = radius * radius;
    float ratio = distance2 / radius2;
    float window = 1.0 - ratio * ratio;
    float attenuation = window * window / max(distance2, d0 * d0);
    // Also a radius of zero; the window alone would leave rounding noise.
    return distance2 < radius2 ? attenuation : 0.0;
}

// 1 inside the inner cone, exactly 0 at and outside the outer one, smooth between; equal cones give a hard edge.
float cone_attenuation(float cosine, float cos_inner, float cos_outer) {
    if (cosine <= cos_outer) {
        return 0.0;
    }
    float t = min((cosine - cos_outer) / max(cos_inner - cos_outer, 1e-6), 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Whether a light gives `position` anything at all.
bool is_in_reach(Light light, vec3 position) {
    vec3 to_light = light.position_radius.xyz - position;
    return dot(to_light, to_light) < light.position_radius.w * light.position_radius.w;
}

// Irradiance (rgb) that a light gives a surface facing it at `position`; `direction` becomes the unit vector towards
// the light, or zero when the light lies exactly there.
vec3 light_irradiance(Light light, vec3 position, out vec3 direction) {
    vec3 to_light = light.position_radius.xyz - position;
    float distance2 = dot(to_light, to_light);
    float attenuation = distance_attenuation(distance2, light.position_radius.w, light.intensity.w);
    direction = to_light * inversesqrt(max(distance2, 1e-30));
#if SPOT_LIGHTS
    if (light.axis_outer.w >= -1.0) {
        attenuation *= cone_attenuation(dot(light.axis_outer.xyz, -direction), light.inner.x, light.axis_outer.w);
    }
#endif
    return light.intensity.rgb * attenuation;
}

#endif
