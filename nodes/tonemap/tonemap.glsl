// What every tone curve shares: fetch, expose, curve, encode, dither. A curve's file defines `tone_curve`.
#include <frame.glsl>
#include <colour.glsl>
#include <exposure.glsl>
#include "dither.glsl"

uniform sampler2D u_color;
uniform float u_gain;  // 2 to the stops asked for
#if METERED
layout(std430) readonly buffer ExposureInput { Exposure metered; };
#endif

out vec4 out_color;

// Largest exposed radiance: beyond it every curve is flat, and the square of it still fits a float.
const float CEILING = 65504.0;

// Exposed scene-linear radiance, 0..CEILING -> display-linear 0..1; values outside 0..1 are clamped by the caller.
vec3 tone_curve(vec3 radiance);

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float scale = u_gain;
#if METERED
    scale *= metered.scale;
#endif
    // Clamped before the multiplication too: infinity times a scale of zero would be NaN.
    vec3 radiance = finite_radiance(texelFetch(u_color, texel, 0).rgb, 3.0e38);
    vec3 exposed = finite_radiance(radiance * scale, CEILING);
    vec3 encoded = srgb_encode(tone_curve(exposed));
    out_color = vec4(dithered(encoded, texel), 1.0);
}
