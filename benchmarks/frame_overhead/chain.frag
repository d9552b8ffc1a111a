#version 450
// A five-tap blur: enough work to be a real pass, little enough that overhead shows.
uniform sampler2D u_source;
out vec4 o_color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_source, 0) - 1;
    vec4 sum = texelFetch(u_source, at, 0) * 0.5;
    sum += texelFetch(u_source, min(at + ivec2(1, 0), last), 0) * 0.125;
    sum += texelFetch(u_source, max(at - ivec2(1, 0), ivec2(0)), 0) * 0.125;
    sum += texelFetch(u_source, min(at + ivec2(0, 1), last), 0) * 0.125;
    sum += texelFetch(u_source, max(at - ivec2(0, 1), ivec2(0)), 0) * 0.125;
    o_color = sum;
}
