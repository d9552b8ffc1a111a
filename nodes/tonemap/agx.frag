#version 450
// AgX (Troy Sobotka, github.com/sobotka/AgX): Rec. 709 is drawn inwards, each channel runs through a sigmoid of its
// logarithm over 16.5 stops around middle grey, and the primaries are pushed back out. The sigmoid is evaluated in
// closed form from the published parameters instead of from a table or a polynomial fit.
#include "tonemap.glsl"

// Columns; OUTSET is the inverse of INSET.
const mat3 INSET = mat3(
    0.842479062253094, 0.0423282422610123, 0.0423756549057051,
    0.0784335999999992, 0.878468636469772, 0.0784336,
    0.0792237451477643, 0.0791661274605434, 0.879142973793104
);
const mat3 OUTSET = mat3(
    1.19687900512017, -0.0528968517574562, -0.0529716355144438,
    -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
    -0.0990297440797205, -0.0989611768448433, 1.15107367264116
);

const float STOPS_BELOW = -10.0;  // of middle grey
const float STOPS_ABOVE = 6.5;
const float MIDDLE_GREY = 0.18;
const float SLOPE = 2.0;          // at the pivot
const vec2 PIVOT = vec2(10.0 / 16.5, 0.5);
const float TOE_POWER = 3.0;
const float SHOULDER_POWER = 3.25;

// The scale at which the bend, rising from the pivot with SLOPE, reaches exactly `reach.y` at `reach.x`.
float bend_scale(vec2 reach, float power) {
    float straight = SLOPE * reach.x;
    return pow((pow(straight / reach.y, power) - 1.0) / pow(straight, power), -1.0 / power);
}

// Toe below the pivot and shoulder above are one formula: choosing its constants first halves the powers taken.
vec3 sigmoid(vec3 x) {
    bvec3 above = greaterThan(x, vec3(PIVOT.x));
    vec3 power = mix(vec3(TOE_POWER), vec3(SHOULDER_POWER), above);
    vec3 scale = mix(vec3(bend_scale(PIVOT, TOE_POWER)), vec3(bend_scale(1.0 - PIVOT, SHOULDER_POWER)), above);
    vec3 straight = SLOPE * abs(x - PIVOT.x);
    vec3 bent = straight / pow(1.0 + pow(straight / scale, power), 1.0 / power);
    return PIVOT.y + mix(-bent, bent, above);
}

vec3 tone_curve(vec3 radiance) {
    vec3 inset = max(INSET * radiance, 1.0e-10);
    vec3 stops = (log2(inset / MIDDLE_GREY) - STOPS_BELOW) / (STOPS_ABOVE - STOPS_BELOW);
    vec3 display = OUTSET * sigmoid(clamp(stops, 0.0, 1.0));
    // The curve is made for a display of gamma 2.2; decoded here because the output is sRGB-encoded.
    return pow(clamp(display, 0.0, 1.0), vec3(2.2));
}
