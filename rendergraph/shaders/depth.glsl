// From a depth-buffer value back to a place: view space and world space, whatever the projection.
//
// The projection's own entries are used, so reversed and standard depth, finite and infinite far planes, off-centre and
// jittered frusta need no case each: clip.z = P22 z + P32 and clip.w = -z give z = -P32 / (depth + P22).
// With reversed infinite depth that is z = -near / depth.
#ifndef DEPTH_GLSL
#define DEPTH_GLSL

#include <frame.glsl>

// Where the far plane lies when it is at infinity [m]: far enough for any scene, small enough to square in float32.
const float FARTHEST = 1e15;

// True where nothing was drawn: the value depth buffers are cleared to.
bool is_background(float depth) {
#if DEPTH_REVERSED
    return depth <= 0.0;
#else
    return depth >= 1.0;
#endif
}

// View-space z [m], negative in front of the camera; -FARTHEST where nothing was drawn, so no division by zero.
float view_z(float depth) {
    return is_background(depth) ? -FARTHEST : -frame.projection[3][2] / (depth + frame.projection[2][2]);
}

// View-space position [m] of the surface seen at uv (0..1 over the image, origin lower left).
vec3 view_position(vec2 uv, float depth) {
    float z = view_z(depth);
    vec2 ndc = uv * 2.0 - 1.0;
    vec2 centre = vec2(frame.projection[2][0], frame.projection[2][1]);
    vec2 focal = vec2(frame.projection[0][0], frame.projection[1][1]);
    return vec3(-z * (ndc + centre) / focal, z);
}

// World-space position [m].
vec3 world_position(vec2 uv, float depth) {
    return (frame.inverse_view * vec4(view_position(uv, depth), 1.0)).xyz;
}

// Distance in front of the camera plane [m] of a world-space position.
float view_depth(vec3 position) {
    return -(frame.view * vec4(position, 1.0)).z;
}

#endif
