#version 450
// Lights a fragment as it is drawn.
#include <depth.glsl>
#include <surface.glsl>
#include <shading.glsl>

uniform vec2 u_size; // of the target [px]

layout(location = 0) out vec4 out_color;

void main() {
    Surface s = fetch_surface();
#if ALPHA_TEST
    if (is_cut_out(s.alpha)) {
        discard;
    }
#endif
    // From the depth, not interpolated: the very position deferred lighting sees, so that shadows fall alike.
    vec3 position = world_position(gl_FragCoord.xy / u_size, gl_FragCoord.z);
    vec3 radiance = s.unlit
        ? s.base_color
        : shade_surface(position, s.normal, s.base_color, s.roughness, s.metallic, s.occlusion, s.emissive);
#if BLENDED_QUEUE
    out_color = vec4(radiance * s.alpha, s.alpha); // premultiplied: glTF's alpha is coverage
#else
    out_color = vec4(radiance, 1.0);
#endif
}
