#version 450
#extension GL_ARB_shader_draw_parameters : require
#if LAYERED
#extension GL_ARB_shader_viewport_layer_array : require
#endif
// The vertex shader of every draw of the scene. One source computes gl_Position for prepass and main pass alike, so that
// an EQUAL depth test leaves no holes.
//
//   DEPTH_ONLY  depth and alpha test alone: no normals
//   ALPHA_TEST  with DEPTH_ONLY: texture coordinates are still needed
//   LAYERED     draw instance k goes to cascade (layer) k
#include <frame.glsl>
#include <scene.glsl>
#if LAYERED
#include <cascades.glsl>
#endif

in vec3 in_position;
#if !DEPTH_ONLY
in vec3 in_normal;
in vec4 in_tangent;
#endif
#if !DEPTH_ONLY || ALPHA_TEST
in vec2 in_uv0;
in vec2 in_uv1;
in vec4 in_color;
#define VARYING out
#include <varyings.glsl>
#endif

invariant gl_Position;

#if !DEPTH_ONLY
vec3 unit_or_zero(vec3 v) {
    float largest = max(max(abs(v.x), abs(v.y)), abs(v.z)); // first, so that no square over- or underflows
    return largest > 0.0 ? normalize(v / largest) : vec3(0.0);
}
#endif

void main() {
    uint index = uint(gl_BaseInstanceARB);
    precise vec4 world = instances[index].world * vec4(in_position, 1.0);
#if LAYERED
    gl_Position = cascades.to_clip[gl_InstanceID] * world;
    gl_Layer = gl_InstanceID;
#else
    gl_Position = frame.view_projection * world;
#endif

#if !DEPTH_ONLY || ALPHA_TEST
    vertex.uv0 = in_uv0;
    vertex.uv1 = in_uv1;
    vertex.color = in_color;
    vertex.material = instances[index].material;
#endif
#if !DEPTH_ONLY
    // Unit length at the vertices, so that scaled instances interpolate like unscaled ones.
    vertex.normal = unit_or_zero(vec3(
        dot(instances[index].normal_0.xyz, in_normal),
        dot(instances[index].normal_1.xyz, in_normal),
        dot(instances[index].normal_2.xyz, in_normal)
    ));
    vertex.tangent.xyz = unit_or_zero(mat3(instances[index].world) * in_tangent.xyz);
    // A mirroring transform turns the cross product of normal and tangent round.
    bool mirrored = (instances[index].flags & MIRRORED) != 0u;
    vertex.tangent.w = mirrored ? -in_tangent.w : in_tangent.w;
#endif
}
