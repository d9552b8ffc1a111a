#version 450
// A round star that fades to its edge, added to what is there.
flat in vec3 v_light;
out vec4 color;

void main() {
    vec2 corner = 2.0 * gl_PointCoord - 1.0;
    float falloff = max(1.0 - dot(corner, corner), 0.0);
    color = vec4(v_light * falloff, 1.0);
}
