#version 450
// An FXAA-class filter, written from the description in Lottes 2009, "FXAA" (NVIDIA white paper): detect a luma edge,
// decide its direction, seek its two ends, and shift the sample across it by where this pixel lies between the ends.
//
// Every read is a texelFetch: the shift is along one axis, so the last read is a blend of two texels, and no result
// hangs on a driver's filtering precision.

uniform sampler2D u_color;
uniform float u_edge_threshold;
uniform float u_edge_minimum;
uniform int u_search_steps;
uniform float u_subpixel;

out vec4 out_color;

const float TIE = 1.0 / 4096.0;

ivec2 limit;  // largest texel

vec4 fetch(ivec2 texel) {
    return texelFetch(u_color, clamp(texel, ivec2(0), limit), 0);
}

// Luma of encoded colour (Rec. 601 weights): contrast as the eye sees it.
float luma(vec3 encoded) {
    return dot(encoded, vec3(0.299, 0.587, 0.114));
}

float luma_at(ivec2 texel) {
    return luma(fetch(texel).rgb);
}

// Texels from one step of the search to the next: dense near the pixel, where the blend is steepest.
int stride(int step) {
    return step < 4 ? 1 : step < 8 ? 2 : 4;
}

// Signed luma difference at the end of the edge, and the distance to it in texels, walking from `texel` along `walk`.
// The edge runs between `texel` and `texel + across`; it has ended where the mean of the pair leaves `edge_luma` by
// more than `tolerance`, which is known to within the last stride: half of it is the best guess.
vec2 seek_end(ivec2 texel, ivec2 across, ivec2 walk, float edge_luma, float tolerance) {
    int distance = 0;
    float difference = 0.0;
    for (int step = 0; step < u_search_steps; ++step) {
        distance += stride(step);
        ivec2 place = texel + walk * distance;
        difference = 0.5 * (luma_at(place) + luma_at(place + across)) - edge_luma;
        if (abs(difference) >= tolerance) {
            return vec2(difference, float(distance) - 0.5 * float(stride(step)));
        }
    }
    return vec2(difference, float(distance));
}

void main() {
    limit = textureSize(u_color, 0) - 1;
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 centre = fetch(texel);

    float m = luma(centre.rgb);
    float n = luma_at(texel + ivec2(0, 1)), s = luma_at(texel + ivec2(0, -1));
    float e = luma_at(texel + ivec2(1, 0)), w = luma_at(texel + ivec2(-1, 0));
    float brightest = max(m, max(max(n, s), max(e, w)));
    float darkest = min(m, min(min(n, s), min(e, w)));
    float contrast = brightest - darkest;
    if (contrast <= max(u_edge_minimum, brightest * u_edge_threshold)) {
        out_color = centre;
        return;
    }

    float ne = luma_at(texel + ivec2(1, 1)), nw = luma_at(texel + ivec2(-1, 1));
    float se = luma_at(texel + ivec2(1, -1)), sw = luma_at(texel + ivec2(-1, -1));

    // Softening of details below a pixel: how far the pixel stands out from the mean around it.
    float mean = (2.0 * (n + s + e + w) + ne + nw + se + sw) / 12.0;
    float stands_out = smoothstep(0.0, 1.0, clamp(abs(mean - m) / contrast, 0.0, 1.0));
    float subpixel_shift = stands_out * stands_out * u_subpixel;

    // Second differences down the columns are largest on a horizontal edge.
    float horizontal = 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e) + abs(nw + sw - 2.0 * w);
    float vertical = 2.0 * abs(e + w - 2.0 * m) + abs(ne + nw - 2.0 * n) + abs(se + sw - 2.0 * s);
    // A pixel that stands out alone gives the same sum both ways: the bias lets no rounding decide.
    bool is_horizontal = horizontal + TIE >= vertical;

    // The edge lies on the side of the steeper step.
    float ahead = is_horizontal ? n : e;
    float behind = is_horizontal ? s : w;
    bool is_ahead = abs(ahead - m) >= abs(behind - m);
    ivec2 across = (is_horizontal ? ivec2(0, 1) : ivec2(1, 0)) * (is_ahead ? 1 : -1);
    ivec2 along = is_horizontal ? ivec2(1, 0) : ivec2(0, 1);
    float beyond = is_ahead ? ahead : behind;
    float edge_luma = 0.5 * (m + beyond);
    float tolerance = 0.25 * abs(m - beyond);

    vec2 positive = seek_end(texel, across, along, edge_luma, tolerance);
    vec2 negative = seek_end(texel, across, -along, edge_luma, tolerance);
    vec2 nearest = positive.y < negative.y ? positive : negative;

    // Only the pixels on the side that the edge turns away from are covered by the other side's colour.
    float edge_shift = 0.0;
    if ((nearest.x < 0.0) != (m < edge_luma)) {
        edge_shift = 0.5 - nearest.y / (positive.y + negative.y);
    }
    float shift = max(edge_shift, subpixel_shift);
    out_color = vec4(mix(centre.rgb, fetch(texel + across).rgb, shift), centre.a);
}
