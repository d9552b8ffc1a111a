#version 450
// Counts a tile's texels into 256 bins of log luminance in shared memory, then adds the bins to the image's.
#include "meter.glsl"

layout(std430) buffer Histogram { uint bins[256]; };

shared uint tile_bins[256];

void main() {
    tile_bins[gl_LocalInvocationIndex] = 0u;
    barrier();
    float bins_per_ev = 255.0 / (u_max_ev - u_min_ev);
    for (int i = 0; i < TEXELS_PER_THREAD; ++i) {
        float ev;
        if (meter(i, ev)) {
            // Bins are centred on their value, so that both ends of the range are met exactly.
            atomicAdd(tile_bins[uint((ev - u_min_ev) * bins_per_ev + 0.5)], 1u);
        }
    }
    barrier();
    uint count = tile_bins[gl_LocalInvocationIndex];
    if (count > 0u) {
        atomicAdd(bins[gl_LocalInvocationIndex], count);
    }
}
