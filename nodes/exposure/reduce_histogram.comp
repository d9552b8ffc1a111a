#version 450
// The mean of the histogram between two percentiles, by one work group: a prefix sum ranks every bin, and a bin counts
// by the part of it that lies between the ranks asked for.
#include "adapt.glsl"

layout(local_size_x = 256) in;

layout(std430) readonly buffer Histogram { uint bins[256]; };
uniform float u_min_ev;
uniform float u_max_ev;
uniform float u_low;
uniform float u_high;

shared uint ranks[256];
shared vec2 sums[256];  // weighted value, weight

void main() {
    uint bin = gl_LocalInvocationIndex;
    ranks[bin] = bins[bin];
    barrier();
    for (uint reach = 1u; reach < 256u; reach <<= 1) {
        uint below = bin >= reach ? ranks[bin - reach] : 0u;
        barrier();
        ranks[bin] += below;
        barrier();
    }
    uint total = ranks[255];
    float first = bin > 0u ? float(ranks[bin - 1u]) : 0.0;
    float weight = max(0.0, min(float(ranks[bin]), u_high * float(total)) - max(first, u_low * float(total)));
    float value = mix(u_min_ev, u_max_ev, float(bin) / 255.0);
    sums[bin] = vec2(weight * value, weight);
    barrier();
    for (uint half_size = 128u; half_size > 0u; half_size >>= 1) {
        if (bin < half_size) {
            sums[bin] += sums[bin + half_size];
        }
        barrier();
    }
    if (bin == 0u) {
        write_exposure(sums[0].x / max(sums[0].y, 1.0e-6), total);
    }
}
