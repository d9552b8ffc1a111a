#version 450
// Counts texels by brightness: first within the work group, then once a bin into the buffer.
layout(local_size_x = TILE_X, local_size_y = TILE_Y) in;

uniform sampler2D u_picture;
layout(std430) buffer Bins { uint bins[64]; };

shared uint local_bins[64];

void main() {
    uint lane = gl_LocalInvocationIndex;
    if (lane < 64u) local_bins[lane] = 0u;
    barrier();
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(texel, textureSize(u_picture, 0)))) {
        float brightness = dot(texelFetch(u_picture, texel, 0).rgb, vec3(0.2126, 0.7152, 0.0722));
        atomicAdd(local_bins[min(uint(brightness * 64.0), 63u)], 1u);
    }
    barrier();
    if (lane < 64u && local_bins[lane] > 0u) atomicAdd(bins[lane], local_bins[lane]);
}
