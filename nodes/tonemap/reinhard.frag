#version 450
// Reinhard, Stark, Shirley and Ferwerda 2002, "Photographic Tone Reproduction for Digital Images", equation 4, on
// luminance: hue and saturation are kept, so bright saturated colours clip.
#include "tonemap.glsl"

uniform float u_white;  // luminance mapped to one

vec3 tone_curve(vec3 radiance) {
    float scene = luminance(radiance);
    // Factored so that no square of the luminance is taken.
    return radiance * ((1.0 + (scene / u_white) / u_white) / (1.0 + scene));
}
