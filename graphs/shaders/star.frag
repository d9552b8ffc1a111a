#version 450
// A slowly turning star with one sample a pixel: edges of every slope, finer than a pixel towards the middle.
#include <frame.glsl>

out vec4 color;

void main() {
    vec2 p = (gl_FragCoord.xy - 0.5 * frame.viewport.xy) * frame.viewport.w;
    float angle = atan(p.y, p.x) + 0.02 * float(frame.counts.x);
    float arm = step(0.0, sin(12.0 * angle)) * step(length(p), 0.45);
    color = vec4(mix(vec3(0.08, 0.1, 0.14), vec3(0.95, 0.9, 0.8), arm), 1.0);
}
