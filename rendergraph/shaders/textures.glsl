// A material's textures: KHR_texture_transform, wrap modes and the fetch from the scene's texture arrays.
//
// TEXTURE_ARRAYS  how many arrays the scene has; 0 leaves all of this out
#ifndef TEXTURES_GLSL
#define TEXTURES_GLSL

#include <scene.glsl>

const uint NO_TEXTURE = 0xffffffffu;
const uint WRAP_CLAMP = 1u;
const uint WRAP_MIRROR = 2u;

#if TEXTURE_ARRAYS
uniform sampler2DArray u_textures[TEXTURE_ARRAYS];

// A sampler array may only be indexed by a value that is the same for all invocations; neighbours of another draw may
// want another array. So: constant indices, chosen by a branch, and gradients from before it.
#if TEXTURE_ARRAYS == 1
#define EACH_ARRAY(DO) DO(0)
#elif TEXTURE_ARRAYS == 2
#define EACH_ARRAY(DO) DO(0) DO(1)
#elif TEXTURE_ARRAYS == 3
#define EACH_ARRAY(DO) DO(0) DO(1) DO(2)
#elif TEXTURE_ARRAYS == 4
#define EACH_ARRAY(DO) DO(0) DO(1) DO(2) DO(3)
#elif TEXTURE_ARRAYS == 5
#define EACH_ARRAY(DO) DO(0) DO(1) DO(2) DO(3) DO(4)
#elif TEXTURE_ARRAYS == 6
#define EACH_ARRAY(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5)
#elif TEXTURE_ARRAYS == 7
#define EACH_ARRAY(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6)
#elif TEXTURE_ARRAYS == 8
#define EACH_ARRAY(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7)
#else
#error more texture arrays than this shader has cases for
#endif

#define FETCH(i) case i: return textureGrad(u_textures[i], coordinate, dx, dy);
#define SIZE(i) case i: return vec2(textureSize(u_textures[i], 0).xy);

vec4 fetch_array(uint array, vec3 coordinate, vec2 dx, vec2 dy) {
    switch (int(array)) {
        EACH_ARRAY(FETCH)
        default: return vec4(1.0);
    }
}

vec2 array_size(uint array) {
    switch (int(array)) {
        EACH_ARRAY(SIZE)
        default: return vec2(1.0);
    }
}

// One coordinate, wrapped. Samplers repeat in hardware; clamped and mirrored coordinates stay `margin` (half a texel of
// the coarsest level read) inside, so that filtering never reaches across the seam.
float wrap_coordinate(float x, uint mode, float margin) {
    if (mode == WRAP_MIRROR) {
        x = 1.0 - abs(mod(x, 2.0) - 1.0);
    } else if (mode != WRAP_CLAMP) {
        return x;
    }
    return clamp(x, margin, 1.0 - margin);
}
#endif

// The texture a reference names, or `otherwise`. dx, dy: screen-space derivatives of `uv`, taken where all invocations
// of a quad still run.
vec4 sample_reference(TextureRef reference, float rotation, vec2 uv, vec2 dx, vec2 dy, vec4 otherwise) {
#if TEXTURE_ARRAYS
    if (reference.array == NO_TEXTURE) {
        return otherwise;
    }
    // Scale, then turn counter-clockwise as seen in the image (v grows downward), then move.
    float c = cos(rotation);
    float s = sin(rotation);
    mat2 turn = mat2(c, -s, s, c);
    vec2 scale = reference.transform.zw;
    uv = turn * (uv * scale) + reference.transform.xy;
    dx = turn * (dx * scale);
    dy = turn * (dy * scale);

    uint wrap_s = reference.wrap & 3u;
    uint wrap_t = (reference.wrap >> 2) & 3u;
    if ((wrap_s | wrap_t) != 0u) {
        vec2 size = array_size(reference.array);
        vec2 texels = max(abs(dx), abs(dy)) * size;
        float coarsest = exp2(ceil(log2(max(max(texels.x, texels.y), 1.0))));
        vec2 margin = min(0.5 * coarsest / size, 0.5);
        uv = vec2(wrap_coordinate(uv.x, wrap_s, margin.x), wrap_coordinate(uv.y, wrap_t, margin.y));
    }
    return fetch_array(reference.array, vec3(uv, float(reference.layer)), dx, dy);
#else
    return otherwise;
#endif
}

#endif
