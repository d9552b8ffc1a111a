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
// The instance of this draw command, as attributes that are the same for all its vertices: llvmpipe walks through the
// lanes of a storage block's load one by one, and would for every vertex.
in mat4 in_world;
#if !DEPTH_ONLY
in vec3 in_normal;
in vec4 in_tangent;
in mat3 in_normal_rows;
#endif
#if !DEPTH_ONLY || ALPHA_TEST
in uvec2 in_material_flags;
#define VARYING out
#include <varyings.glsl>
in vec2 in_uv0;
#if SECOND_UV
in vec2 in_uv1;
#endif
#if VERTEX_COLORS
in vec4 in_color;
#endif
#endif

invariant gl_Position;

#if !DEPTH_ONLY
vec3 unit_or_zero(vec3 v) {
    float largest = max(max(abs(v.x), abs(v.y)), abs(v.z)); // first, so that no square over- or underflows
    return largest > 0.0 ? normalize(v / largest) : vec3(0.0);
}
#endif

void main() {
    precise vec4 world = in_world * vec4(in_position, 1.0);
#if LAYERED
    gl_Position = cascades.to_clip[gl_InstanceID] * world;
    gl_Layer = gl_InstanceID;
#else
    gl_Position = frame.view_projection * world;
#endif

#if !DEPTH_ONLY || ALPHA_TEST
    vertex.uv0 = in_uv0;
#if SECOND_UV
    vertex.uv1 = in_uv1;
#endif
#if VERTEX_COLORS
    vertex.color = in_color;
#endif
    vertex.material = in_material_flags.x;
#endif
#if !DEPTH_ONLY
    // Unit length at the vertices, so that scaled instances interpolate like unscaled ones.
    vertex.normal = unit_or_zero(in_normal * in_normal_rows);
    vertex.tangent.xyz = unit_or_zero(mat3(in_world) * in_tangent.xyz);
    // A mirroring transform turns the cross product of normal and tangent round.
    bool mirrored = (in_material_flags.y & MIRRORED) != 0u;
    vertex.tangent.w = mirrored ? -in_tangent.w : in_tangent.w;
#endif
}
