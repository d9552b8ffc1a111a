#version 450
// A chain of dependent multiply-adds: a load no compiler can shorten, since the number of steps is a uniform.
uniform int u_steps;
in vec2 v_uv;
out float o_value;

void main() {
    float value = v_uv.x + v_uv.y;
    for (int i = 0; i < u_steps; ++i) {
        value = value * 0.999 + 0.001 * v_uv.x;
    }
    o_value = value;
}
