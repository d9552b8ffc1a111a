#version 450
// Lights the surface stored at this pixel.
#include <depth.glsl>
#include <packing.glsl>
#include <shading.glsl>

in vec2 v_uv;

uniform sampler2D u_depth;
uniform sampler2D u_normal;
uniform sampler2D u_base_color;
uniform sampler2D u_material;
#if EMISSIVE
uniform sampler2D u_emissive;
#endif
#if OCCLUSION
uniform sampler2D u_occlusion;
#endif

layout(location = 0) out vec4 out_color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(u_depth, pixel, 0).r;
    if (is_background(depth)) {
        out_color = vec4(0.0, 0.0, 0.0, 1.0);
        return;
    }
    vec3 base_color = texelFetch(u_base_color, pixel, 0).rgb;
    vec4 material = texelFetch(u_material, pixel, 0);
#if UNLIT_SURFACES
    if (material.a > 0.5) {
        out_color = vec4(base_color, 1.0);
        return;
    }
#endif
    vec3 normal = unpack_normal(texelFetch(u_normal, pixel, 0));
    vec3 emissive = vec3(0.0);
#if EMISSIVE
    emissive = texelFetch(u_emissive, pixel, 0).rgb;
#endif
    float occlusion = material.b;
#if OCCLUSION
    occlusion *= texture(u_occlusion, v_uv).r;
#endif
    vec3 position = world_position(gl_FragCoord.xy / vec2(textureSize(u_depth, 0)), depth);
    out_color = vec4(shade_surface(position, normal, base_color, material.r, material.g, occlusion, emissive), 1.0);
}
