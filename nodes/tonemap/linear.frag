#version 450
// No curve: what exceeds one is clipped.
#include "tonemap.glsl"

vec3 tone_curve(vec3 radiance) {
    return clamp(radiance, 0.0, 1.0);
}
