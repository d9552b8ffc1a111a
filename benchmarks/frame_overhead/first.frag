#version 450
out vec4 o_color;

void main() {
    o_color = vec4(fract(gl_FragCoord.xy / 64.0), 0.5, 1.0);
}
