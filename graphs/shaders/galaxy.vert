#version 450
#extension GL_ARB_shader_draw_parameters : require
// A spiral galaxy that turns with the frame number, a star a point. The star is told by base instance plus instance, so
// that one instanced draw and a draw a star make the same picture.
#include <frame.glsl>

uniform int u_arms;          // arms of the spiral
uniform int u_count;         // stars in all
uniform float u_turn;        // turns a frame
uniform float u_size;        // width of the largest star, of the picture's height

flat out vec3 v_light;       // linear

const float TAU = 6.28318530718;

// Four numbers in 0..1 of one (PCG-3D, Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 2020; the fourth mixed
// of the three).
vec4 dice_of(uint seed) {
    uvec3 v = uvec3(seed, 17u, 91u) * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    return vec4(uvec4(v, (v.x ^ v.y) * 747796405u + v.z) >> 8u) * (1.0 / 16777216.0);
}

void main() {
    int star = gl_BaseInstanceARB + gl_InstanceID;
    vec4 dice = dice_of(uint(star));
    float along = (float(star) + dice.x) / float(u_count);
    float angle = TAU * (float(star % u_arms) / float(u_arms) + 0.8 * along + u_turn * float(frame.counts.x));
    angle += (dice.y - 0.5) * mix(1.6, 0.45, along);
    float radius = 0.06 + 0.92 * along;
    vec3 place = vec3(radius * cos(angle), (dice.z - 0.5) * mix(0.22, 0.03, along), radius * sin(angle));

    float c = cos(0.95), s = sin(0.95);              // seen from above the plane, at a slant
    vec2 seen = vec2(place.x, c * place.y - s * place.z);
    float bright = dice.w * dice.w;
    v_light = mix(vec3(1.0, 0.72, 0.42), vec3(0.55, 0.7, 1.0), along) * mix(0.08, 0.9, bright);
    float aspect = frame.viewport.x * frame.viewport.w;
    gl_Position = vec4(1.5 * seen.x / aspect, 1.5 * seen.y, 0.5, 1.0);
    gl_PointSize = max(1.0, u_size * mix(0.3, 1.0, bright) * frame.viewport.y);
}
