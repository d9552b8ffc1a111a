#version 450
// A slowly turning star with one sample a pixel: edges of every slope, none along the pixels' rows, from strong to faint,
// and finer than a pixel towards the middle.
#include <frame.glsl>

out vec4 color;

const float ARMS = 12.0;
const float TAU = 6.28318530718;

void main() {
    vec2 p = (gl_FragCoord.xy - 0.5 * frame.viewport.xy) * frame.viewport.w;
    float turn = fract(atan(p.y, p.x) / TAU + 0.0103 + 0.003 * float(frame.counts.x)) * ARMS;
    float arm = step(fract(turn), 0.5) * step(length(p), 0.45);
    float strength = exp2(-0.4 * floor(turn));  // of the arm: from 1 down to 0.05
    color = vec4(mix(vec3(0.08, 0.1, 0.14), vec3(0.95, 0.9, 0.8), arm * strength), 1.0);
}
