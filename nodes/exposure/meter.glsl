// What both meters read: the clamped log2 luminance of the texels of one work group's tile, 16 x 16 threads of 2 x 2.
#include <colour.glsl>

layout(local_size_x = 16, local_size_y = 16) in;

uniform sampler2D u_color;
uniform float u_min_ev;
uniform float u_max_ev;

const int TEXELS_PER_THREAD = 4;

// Log2 luminance within u_min_ev..u_max_ev of one texel of this thread. False where the tile overhangs the image or
// the texel holds a NaN or an infinity, which must not be metered.
bool meter(int index, out float ev) {
    ivec2 tile = ivec2(gl_WorkGroupID.xy) * 32 + ivec2(gl_LocalInvocationID.xy) + 16 * ivec2(index & 1, index >> 1);
    ivec2 texel = tile * STRIDE;
    if (any(greaterThanEqual(texel, textureSize(u_color, 0)))) {
        return false;
    }
    vec3 radiance = texelFetch(u_color, texel, 0).rgb;
    float y = luminance(max(radiance, 0.0));
    // Bounded below before the logarithm, above after it: a finite radiance may have an infinite luminance.
    ev = clamp(log2(max(y, 1.0e-30)), u_min_ev, u_max_ev);
    return is_finite(radiance);
}
