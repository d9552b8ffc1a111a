#version 450
// One generation of Conway's Game of Life on a torus; dead cells remember how long they have been dead, for display.
#include <frame.glsl>

layout(local_size_x = TILE_X, local_size_y = TILE_Y) in;

uniform usampler2D u_last;                      // read: a sampler of the port's name
layout(r8ui) uniform writeonly uimage2D u_cells; // write: an image of the port's name

const uint ALIVE = 255u;

// Integer hash of two words (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 2020, pcg2d).
uvec2 hash(uvec2 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    return v ^ (v >> 16u);
}

void main() {
    ivec2 size = imageSize(u_cells);
    ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(cell, size))) return;

    if (frame.counts.x == 0u) { // history is empty in the first frame: start from seeded noise
        uint noise = hash(uvec2(cell) + uvec2(frame.counts.y, 0u)).x;
        imageStore(u_cells, cell, uvec4(noise < 0x50000000u ? ALIVE : 0u));
        return;
    }
    uint neighbours = 0u;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            if (x != 0 || y != 0)
                neighbours += uint(texelFetch(u_last, (cell + ivec2(x, y) + size) % size, 0).r == ALIVE);
    uint before = texelFetch(u_last, cell, 0).r;
    bool alive = neighbours == 3u || (neighbours == 2u && before == ALIVE);
    imageStore(u_cells, cell, uvec4(alive ? ALIVE : before * 15u / 16u));
}
