#version 450
// Eight by eight tiles with dark joints.
in vec2 v_uv;
out vec4 color;

void main() {
    vec2 at = v_uv * 8.0;
    vec2 tile = floor(at), inside = fract(at);
    float joint = step(0.06, min(min(inside.x, inside.y), min(1.0 - inside.x, 1.0 - inside.y)));
    float odd = mod(tile.x + tile.y, 2.0);
    vec3 glaze = mix(vec3(0.92, 0.90, 0.84), vec3(0.12, 0.32, 0.48), odd);
    glaze *= 0.92 + 0.08 * sin(dot(tile, vec2(12.9898, 78.233)));
    color = vec4(mix(vec3(0.08), glaze, joint), 1.0);
}
