#version 450
// Clouds over a blue sky; encodes for display.
#include <colour.glsl>

uniform sampler2D u_clouds;  // premultiplied linear radiance, coverage in alpha; of any size

in vec2 v_uv;
out vec4 color;

void main() {
    vec3 sky = mix(vec3(0.62, 0.74, 0.86), vec3(0.11, 0.26, 0.56), smoothstep(0.0, 0.9, v_uv.y));
    vec4 clouds = texture(u_clouds, v_uv);
    vec3 linear = sky * (1.0 - clouds.a) + clouds.rgb;
    color = vec4(srgb_encode(linear / (1.0 + 0.25 * linear)), 1.0);
}
