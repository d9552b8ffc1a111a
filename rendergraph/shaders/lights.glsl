// Local lights. Layout mirrored by rendergraph/scene/gpu_layout.py.
//
//   SPOT_LIGHTS  0: all are points, and cones are not compiled
#ifndef LIGHTS_GLSL
#define LIGHTS_GLSL

#ifndef SPOT_LIGHTS
#define SPOT_LIGHTS 1
#endif

// 64 bytes
struct Light {
    vec4 position_radius;  // xyz world [m], w reach [m]: exactly dark at and beyond it
    vec4 intensity;        // rgb radiant intensity, w minimum distance d0 [m]
    vec4 axis_outer;       // spot: xyz unit axis (the way the light travels), w cos(outer half angle); points: w = -2
    vec4 inner;            // x cos(inner half angle), yzw unused
};

layout(std430) readonly buffer Lights { Light lights[]; };

// Irradiance per intensity [1/m^2] at squared distance `distance2`: inverse square, windowed to be exactly zero at and
// beyond `radius` (Karis, "Real shading in Unreal Engine 4", 2013), and bounded by 1 / d0^2 at the light itself.
float distance_attenuation(float distance2, float radius, float d0) {
    float radius2 = radius * radius;
    if (distance2 >= radius2) { // also a radius of zero; the window alone would leave rounding noise
        return 0.0;
    }
    float ratio = distance2 / radius2;
    float window = 1.0 - ratio * ratio;
    return window * window / max(distance2, d0 * d0);
}

// 1 inside the inner cone, exactly 0 at and outside the outer one, smooth between; equal cones give a hard edge.
float cone_attenuation(float cosine, float cos_inner, float cos_outer) {
    if (cosine <= cos_outer) {
        return 0.0;
    }
    float t = min((cosine - cos_outer) / max(cos_inner - cos_outer, 1e-6), 1.0);
    return t * t * (3.0 - 2.0 * t);
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
