#version 450
// Sines of position and time, summed and coloured by a cosine palette (Quilez, "Palettes", iquilezles.org).
#include <frame.glsl>

in vec2 v_uv;                // 0..1 over the target, origin lower left
out vec4 color;              // the first texture the pass writes; 8-bit targets are display-referred

uniform float u_scale;       // waves over the height of the target
uniform float u_speed;       // turns of the pattern a frame
uniform vec3 u_tint;         // phase of red, green and blue

const float TAU = 6.28318530718;

void main() {
    float time = TAU * u_speed * float(frame.counts.x);
    float aspect = frame.viewport.x * frame.viewport.w;
    vec2 p = (v_uv - 0.5) * vec2(aspect, 1.0) * u_scale;
    float wave = sin(TAU * p.x + time)
               + sin(TAU * (p.y * 0.8 + 0.3 * sin(2.0 * p.x)) - time)
               + sin(TAU * length(p - 0.4 * vec2(sin(time), cos(time))));
    color = vec4(0.5 + 0.5 * cos(0.9 * wave + TAU * u_tint), 1.0);
}
