#version 450
// Light for display: a square root stands in for the sRGB curve.
uniform sampler2D u_light;

in vec2 v_uv;
out vec4 color;

void main() { color = vec4(sqrt(clamp(texture(u_light, v_uv).rgb, 0.0, 1.0)), 1.0); }
