#version 450
// Stores a surface instead of lighting it.
#include <surface.glsl>
#include <packing.glsl>

layout(location = 0) out vec4 out_normal;
layout(location = 1) out vec4 out_base_color;
layout(location = 2) out vec4 out_material;
#if EMISSIVE
layout(location = 3) out vec4 out_emissive;
#endif

void main() {
    Surface s = fetch_surface();
#if ALPHA_TEST
    if (is_cut_out(s.alpha)) {
        discard;
    }
#endif
    out_normal = pack_normal(s.normal);
    out_base_color = vec4(s.base_color, 1.0);
    out_material = pack_material(s.roughness, s.metallic, s.occlusion, s.unlit);
#if EMISSIVE
    out_emissive = vec4(min(s.emissive, 64512.0), 1.0); // the largest value of every channel of r11g11b10f
#endif
}
