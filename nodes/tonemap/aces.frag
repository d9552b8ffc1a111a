#version 450
// Stephen Hill's fit of the ACES reference rendering and sRGB output transforms, as published in the code of
// "Baking Lab" (Pettineo and Neubelt, MIT): into a compressed AP1, a rational curve, and back to Rec. 709.
#include "tonemap.glsl"

// Columns.
const mat3 TO_AP1 = mat3(
    0.59719, 0.07600, 0.02840,
    0.35458, 0.90834, 0.13383,
    0.04823, 0.01566, 0.83777
);
const mat3 FROM_AP1 = mat3(
    1.60475, -0.10208, -0.00327,
    -0.53108, 1.10813, -0.07276,
    -0.07367, -0.00605, 1.07602
);

vec3 tone_curve(vec3 radiance) {
    vec3 v = TO_AP1 * radiance;
    vec3 numerator = v * (v + 0.0245786) - 0.000090537;
    vec3 denominator = v * (0.983729 * v + 0.4329510) + 0.238081;
    return clamp(FROM_AP1 * (numerator / denominator), 0.0, 1.0);
}
