// A material's textures: KHR_texture_transform, wrap modes and the fetch from the slot's texture array.
//
//   TEXTURE_SLOTS       bit per slot of Material.textures that some material of the scene fills; 0 leaves all of this out
//   TEXTURE_TRANSFORMS  0: no texture is moved, turned or scaled
//   TEXTURE_WRAPS       0: all textures repeat
#ifndef TEXTURES_GLSL
#define TEXTURES_GLSL

#ifndef TEXTURE_SLOTS
#define TEXTURE_SLOTS 31
#endif
#ifndef TEXTURE_TRANSFORMS
#define TEXTURE_TRANSFORMS 1
#endif
#ifndef TEXTURE_WRAPS
#define TEXTURE_WRAPS 1
#endif

#include <scene.glsl>

const uint NO_TEXTURE = 0xffffffffu;
const uint WRAP_CLAMP = 1u;
const uint WRAP_MIRROR = 2u;

#if TEXTURE_SLOTS
// The array that each slot's texture lies in. A draw command has materials of one set of arrays alone: which array, and
// even which slot, may then be computed, as long as all invocations of a draw compute the same.
uniform sampler2DArray u_textures[5];

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

// The texture of a slot. dx, dy: screen-space derivatives of `uv`, taken where all invocations of a quad still run.
vec4 sample_reference(TextureRef reference, int slot, float rotation, vec2 uv, vec2 dx, vec2 dy) {
#if TEXTURE_TRANSFORMS
    // Scale, then turn counter-clockwise as seen in the image (v grows downward), then move.
    float c = cos(rotation);
    float s = sin(rotation);
    mat2 turn = mat2(c, -s, s, c);
    vec2 scale = reference.transform.zw;
    uv = turn * (uv * scale) + reference.transform.xy;
    dx = turn * (dx * scale);
    dy = turn * (dy * scale);
#endif
#if TEXTURE_WRAPS
    uint wrap_s = reference.wrap & 3u;
    uint wrap_t = (reference.wrap >> 2) & 3u;
    if ((wrap_s | wrap_t) != 0u) {
        vec2 size = vec2(textureSize(u_textures[slot], 0).xy);
        vec2 texels = max(abs(dx), abs(dy)) * size;
        float coarsest = exp2(ceil(log2(max(max(texels.x, texels.y), 1.0))));
        vec2 margin = min(0.5 * coarsest / size, 0.5);
        uv = vec2(wrap_coordinate(uv.x, wrap_s, margin.x), wrap_coordinate(uv.y, wrap_t, margin.y));
    }
#endif
    return textureGrad(u_textures[slot], vec3(uv, float(reference.layer)), dx, dy);
}
#endif

#endif
