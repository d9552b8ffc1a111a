#version 450
// Instances of a cube on a ring that turns with the frame number; a camera of its own, as the graph has no scene.
#include <frame.glsl>

uniform int u_count;         // instances on the ring
uniform float u_turn;        // turns of the ring a frame

out vec3 v_normal;           // world space
flat out float v_place;      // 0..1 along the ring

const float TAU = 6.28318530718;
const float NEAR = 0.1;

mat3 rotate_y(float a) { float c = cos(a), s = sin(a); return mat3(c, 0, -s, 0, 1, 0, s, 0, c); }
mat3 rotate_x(float a) { float c = cos(a), s = sin(a); return mat3(1, 0, 0, 0, c, s, 0, -s, c); }

// Two counter-clockwise triangles a face, faces in the order +x -x +y -y +z -z.
vec3 cube_corner(int vertex, out vec3 normal) {
    int face = vertex / 6;
    vec2 corner = vec2[](vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, -1), vec2(1, 1), vec2(-1, 1))[vertex % 6];
    float side = (face & 1) == 0 ? 1.0 : -1.0;
    corner.x *= side; // mirrored faces keep their winding
    if (face < 2) { normal = vec3(side, 0, 0); return vec3(side, corner); }
    if (face < 4) { normal = vec3(0, side, 0); return vec3(corner.y, side, corner.x); }
    normal = vec3(0, 0, side);
    return vec3(corner, side);
}

void main() {
    vec3 normal;
    vec3 corner = cube_corner(gl_VertexID, normal);
    v_place = float(gl_InstanceID) / float(u_count);
    float angle = TAU * (v_place + u_turn * float(frame.counts.x));
    mat3 turn = rotate_y(angle) * rotate_x(3.0 * angle);
    vec3 world = turn * (0.16 * corner) + 2.0 * vec3(sin(angle), 0.0, cos(angle));
    v_normal = turn * normal;

    mat3 tilt = rotate_x(0.45);
    vec3 view = tilt * world - vec3(0.0, 0.0, 4.2);
    float focal = 1.9;
    float aspect = frame.viewport.x * frame.viewport.w;
#if DEPTH_REVERSED
    float z = NEAR;                  // infinite far plane: depth = near / distance
#else
    float z = -view.z - NEAR;        // depth = 1 - near / distance
#endif
    gl_Position = vec4(view.x * focal / aspect, view.y * focal, z, -view.z);
}
