#version 450
// Hues from left to right, 16 stops of radiance from bottom to top: what a tone curve is judged by.
in vec2 v_uv;
out vec4 color;

void main() {
    float hue = v_uv.x * 6.0;
    vec3 pure = clamp(vec3(abs(hue - 3.0) - 1.0, 2.0 - abs(hue - 2.0), 2.0 - abs(hue - 4.0)), 0.0, 1.0);
    vec3 tint = mix(vec3(1.0), pure, step(0.1, v_uv.x));  // the first tenth is grey
    color = vec4(0.18 * tint * exp2(v_uv.y * 16.0 - 8.0), 1.0);
}
