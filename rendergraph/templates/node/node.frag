#version 450
#include <colour.glsl>

uniform sampler2D u_color;
uniform float u_strength; // 0 none .. 1 whole
out vec4 o_color;

void main() {
    vec4 texel = texelFetch(u_color, ivec2(gl_FragCoord.xy), 0);
    o_color = vec4(mix(texel.rgb, vec3(luminance(texel.rgb)), u_strength), texel.a);
}
