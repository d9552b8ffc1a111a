#version 450
// Writes depth alone; with ALPHA_TEST, except where an alpha-tested material is cut out.
#if ALPHA_TEST
#include <surface.glsl>
#endif

void main() {
#if ALPHA_TEST
    vec4 texel = sample_material(SLOT_BASE_COLOR);
    if (is_cut_out(material_base_color(texel).a)) {
        discard;
    }
#endif
}
