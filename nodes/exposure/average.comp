#version 450
// Sums a tile's log luminances, in a fixed order so that the result is the same on every run.
#include "meter.glsl"
#include "partial.glsl"

layout(std430) writeonly buffer Partials { Partial partials[]; };

shared Partial sums[256];

void main() {
    Partial own = Partial(0.0, 0u);
    for (int i = 0; i < TEXELS_PER_THREAD; ++i) {
        float ev;
        if (meter(i, ev)) {
            own.sum += ev;
            own.count += 1u;
        }
    }
    uint thread = gl_LocalInvocationIndex;
    sums[thread] = own;
    barrier();
    for (uint half_size = 128u; half_size > 0u; half_size >>= 1) {
        if (thread < half_size) {
            sums[thread].sum += sums[thread + half_size].sum;
            sums[thread].count += sums[thread + half_size].count;
        }
        barrier();
    }
    if (thread == 0u) {
        partials[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = sums[0];
    }
}
