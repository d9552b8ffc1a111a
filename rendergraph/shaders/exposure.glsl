// What the exposure node writes and tonemapping reads: 16 bytes, std430.
#ifndef EXPOSURE_GLSL
#define EXPOSURE_GLSL

struct Exposure {
    float scale;          // multiply linear radiance by this
    float log_luminance;  // log2 of the luminance the scale was chosen for, after adaptation
    float measured;       // log2 of this frame's average luminance, before adaptation
    uint texels;          // finite texels measured; 0 when none was, or nothing was measured
};

#endif
