// The light that leaves a surface towards the eye: the same code for deferred and forward shading.
//
//   SUN, SUN_SHADOW, AMBIENT, LOCAL_LIGHTS, SPOT_LIGHTS  0 or 1: what the scene has; the rest is not compiled
#ifndef SHADING_GLSL
#define SHADING_GLSL

#include <frame.glsl>
#include <brdf.glsl>
#if SUN_SHADOW
#include <shadow.glsl>
#endif
#if LOCAL_LIGHTS
#include <lights.glsl>
#endif

// The largest finite half float: beyond it an rgba16f target holds infinity, and the next blend or blur NaN.
const float MAX_RADIANCE = 65504.0;

// Radiance of the ambient hemisphere from `direction`, seen by a lobe as wide as `roughness`. At roughness 1 this is the
// cosine-weighted mean over the hemisphere around `direction`, exactly.
vec3 ambient_radiance(vec3 direction, float roughness) {
    float width = mix(0.05, 1.0, roughness);
    return mix(frame.ambient_ground.rgb, frame.ambient_sky.rgb, clamp(0.5 + 0.5 * direction.y / width, 0.0, 1.0));
}

// Ambient light: diffuse takes what the specular lobe leaves, so a white surface under white light stays white.
vec3 shade_ambient(Brdf b, float roughness) {
    vec3 reflected = environment_reflectance(b, roughness);
    vec3 mirror = reflect(-b.view, b.normal);
    return reflected * ambient_radiance(mirror, roughness)
        + (1.0 - reflected) * b.albedo * ambient_radiance(b.normal, 1.0);
}

// Radiance towards the camera. position [m] and normal (unit) in world space; occlusion dims the ambient light only.
vec3 shade_surface(
    vec3 position, vec3 normal, vec3 base_color, float roughness, float metallic, float occlusion, vec3 emissive
) {
    vec3 to_eye = frame.camera.xyz - position;
    vec3 view = to_eye * inversesqrt(max(dot(to_eye, to_eye), 1e-30));
    Brdf b = make_brdf(normal, view, base_color, roughness, metallic);
    vec3 radiance = emissive;
#if AMBIENT
    radiance += occlusion * shade_ambient(b, roughness);
#endif
#if SUN
    vec3 sun = frame.sun_irradiance.rgb * evaluate_brdf(b, frame.sun_direction.xyz);
#if SUN_SHADOW
    if (dot(normal, frame.sun_direction.xyz) > 0.0) {
        sun *= sun_visibility(position, normal);
    }
#endif
    radiance += sun;
#endif
#if LOCAL_LIGHTS
    for (uint i = 0u; i < frame.counts.z; ++i) {
        // One branch around all of it, not one around each part that may be dark: a software rasteriser runs both sides.
        if (is_in_reach(lights[i], position)) {
            vec3 direction;
            vec3 irradiance = light_irradiance(lights[i], position, direction);
            radiance += irradiance * evaluate_brdf(b, direction);
        }
    }
#endif
    return min(radiance, MAX_RADIANCE);
}

#endif
