#version 450
// The mean of all tiles' sums, by one work group.
#include "adapt.glsl"
#include "partial.glsl"

layout(local_size_x = 256) in;

layout(std430) readonly buffer Partials { Partial partials[]; };
uniform int u_partials;

shared Partial sums[256];

void main() {
    uint thread = gl_LocalInvocationIndex;
    Partial own = Partial(0.0, 0u);
    for (uint i = thread; i < uint(u_partials); i += 256u) {
        own.sum += partials[i].sum;
        own.count += partials[i].count;
    }
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
        write_exposure(sums[0].sum / max(float(sums[0].count), 1.0), sums[0].count);
    }
}
