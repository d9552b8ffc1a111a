#version 450
// Living cells bright, dead ones fading from violet to black.
in vec2 v_uv;
out vec4 color;

uniform usampler2D u_cells;

void main() {
    uint cell = texelFetch(u_cells, ivec2(v_uv * vec2(textureSize(u_cells, 0))), 0).r;
    float trail = float(cell) / 255.0;
    vec3 dead = mix(vec3(0.02, 0.02, 0.06), vec3(0.45, 0.15, 0.75), trail * trail);
    color = vec4(cell == 255u ? vec3(1.0, 0.92, 0.6) : dead, 1.0);
}
