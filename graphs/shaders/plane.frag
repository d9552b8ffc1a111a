#version 450
// A plane to the horizon: without mip levels it dissolves into moire, with them it turns to its mean colour.
#include <frame.glsl>

in vec2 v_uv;
out vec4 color;

uniform sampler2D u_tiles;
uniform sampler2D u_pyramid;

void main() {
    float aspect = frame.viewport.x * frame.viewport.w;
    float below = 0.72 - v_uv.y;                       // under the horizon
    float distance = 0.35 / max(below, 1e-4);          // of the plane's point, for an eye 0.35 above it
    vec2 plane = vec2((v_uv.x - 0.5) * aspect * distance, distance);
    vec3 bare = textureLod(u_tiles, plane, 0.0).rgb;
    vec3 mipped = texture(u_pyramid, plane).rgb;
    vec3 sky = mix(vec3(0.75, 0.83, 0.92), vec3(0.30, 0.50, 0.80), clamp((v_uv.y - 0.72) / 0.28, 0.0, 1.0));
    vec3 ground = v_uv.x < 0.5 ? bare : mipped;
    float seam = abs(v_uv.x - 0.5) * frame.viewport.x;
    color = vec4(below > 0.0 ? ground : sky, 1.0) * (seam < 1.0 ? 0.2 : 1.0);
}
