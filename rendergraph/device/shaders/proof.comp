#version 450
// The same load as proof.frag, dispatched.
layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f) writeonly uniform image2D u_out;
uniform int u_steps;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    vec2 uv = (vec2(texel) + 0.5) / vec2(imageSize(u_out));
    float value = uv.x + uv.y;
    for (int i = 0; i < u_steps; ++i) {
        value = value * 0.999 + 0.001 * uv.x;
    }
    imageStore(u_out, texel, vec4(value));
}
