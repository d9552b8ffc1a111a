#version 450
// A hemisphere and a sun over a cosine palette.
in vec3 v_normal;
flat in float v_place;
out vec4 color;

void main() {
    vec3 n = normalize(v_normal);
    vec3 albedo = 0.55 + 0.45 * cos(6.28318530718 * (v_place + vec3(0.0, 0.33, 0.67)));
    float sun = max(dot(n, normalize(vec3(0.4, 0.8, 0.45))), 0.0);
    vec3 light = mix(vec3(0.10, 0.09, 0.08), vec3(0.22, 0.26, 0.34), 0.5 + 0.5 * n.y) + vec3(0.85, 0.8, 0.7) * sun;
    color = vec4(pow(albedo * light, vec3(1.0 / 2.2)), 1.0); // the 8-bit target is display-referred
}
