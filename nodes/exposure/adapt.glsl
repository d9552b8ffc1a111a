// The end of every mode: adapt in stops from the last exposure, then write scale = 2^compensation * grey / luminance.
#include <exposure.glsl>

uniform float u_compensation;
layout(std430) writeonly buffer ExposureOutput { Exposure exposure_output; };
#if ADAPTS
uniform float u_brighten;
uniform float u_darken;
layout(std430) readonly buffer ExposurePrevious { Exposure exposure_previous; };
#endif

const float LOG_MIDDLE_GREY = -2.4739311883324122;  // log2(0.18)

// `measured` is log2 of the average luminance of `texels` texels; with none of them the last exposure is kept, or the
// compensation alone applies.
void write_exposure(float measured, uint texels) {
    float adapted = texels > 0u ? measured : LOG_MIDDLE_GREY;
#if ADAPTS
    // A history of zeros is the frame before the first one.
    if (exposure_previous.scale > 0.0) {
        float last = exposure_previous.log_luminance;
        float target = texels > 0u ? measured : last;
        adapted = mix(last, target, target < last ? u_brighten : u_darken);
    }
#endif
    exposure_output.scale = exp2(u_compensation + LOG_MIDDLE_GREY - adapted);
    exposure_output.log_luminance = adapted;
    exposure_output.measured = texels > 0u ? measured : adapted;
    exposure_output.texels = texels;
}
