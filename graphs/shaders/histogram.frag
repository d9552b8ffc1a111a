#version 450
// The picture, and its histogram as bars over the lower part; a bar of full height holds six times the mean count.
in vec2 v_uv;
out vec4 color;

uniform sampler2D u_picture;
layout(std430) readonly buffer Bins { uint bins[64]; };

void main() {
    ivec2 size = textureSize(u_picture, 0);
    vec3 picture = texture(u_picture, v_uv).rgb;
    vec2 panel = (v_uv - vec2(0.05, 0.06)) / vec2(0.9, 0.4);
    if (any(lessThan(panel, vec2(0.0))) || any(greaterThanEqual(panel, vec2(1.0)))) {
        color = vec4(picture, 1.0);
        return;
    }
    int bin = int(panel.x * 64.0);
    float mean = float(size.x * size.y) / 64.0;
    float height = float(bins[bin]) / (6.0 * mean);
    bool bar = panel.y < height && fract(panel.x * 64.0) > 0.15;
    color = vec4(bar ? vec3(1.0, 0.85, 0.35) : 0.35 * picture, 1.0);
}
