// A fragment's surface, from its interpolated vertex and its material.
//
//   NORMAL_MAP     some material of the scene has a normal map
//   BACK_FACES     some material shows its back; else faces are not told apart
//   UNLIT_SURFACES some material is not lit
//   textures.glsl and varyings.glsl list what else a scene may lack
#ifndef SURFACE_GLSL
#define SURFACE_GLSL

#ifndef BACK_FACES
#define BACK_FACES 1
#endif
#ifndef UNLIT_SURFACES
#define UNLIT_SURFACES 1
#endif

#include <scene.glsl>
#include <textures.glsl>
#define VARYING in
#include <varyings.glsl>

// Slots of Material.textures.
const int SLOT_BASE_COLOR = 0;
const int SLOT_METALLIC_ROUGHNESS = 1;
const int SLOT_NORMAL = 2;
const int SLOT_OCCLUSION = 3;
const int SLOT_EMISSIVE = 4;

// One texture of the fragment's material; white where it has none, the neutral factor of all five but the normal.
vec4 sample_material(int slot) {
#if TEXTURE_SLOTS
    TextureRef reference = materials[vertex.material].textures[slot];
    vec2 uv = vertex.uv0;
    vec2 dx = dFdx(vertex.uv0);
    vec2 dy = dFdy(vertex.uv0);
#if SECOND_UV
    bool second = reference.uv_set == 1u;
    uv = second ? vertex.uv1 : uv;
    dx = second ? dFdx(vertex.uv1) : dx;
    dy = second ? dFdy(vertex.uv1) : dy;
#endif
    vec4 rotations = materials[vertex.material].rotation_0;
    float rotation = slot < 4 ? rotations[slot] : materials[vertex.material].rotation_1.x;
    if (reference.array != NO_TEXTURE) {
        return sample_reference(reference, slot, rotation, uv, dx, dy);
    }
#endif
    return vec4(1.0);
}

// Linear base colour with its alpha.
vec4 material_base_color(vec4 texel) {
    vec4 color = materials[vertex.material].base_color * texel;
#if VERTEX_COLORS
    color *= vertex.color;
#endif
    return color;
}

// True where an alpha-tested material is cut out.
bool is_cut_out(float alpha) {
    return (materials[vertex.material].flags & MASKED) != 0u && alpha < materials[vertex.material].emissive.w;
}

#if !DEPTH_ONLY
struct Surface {
    vec3 normal;      // world, unit, on the viewer's side of double-sided geometry
    vec3 base_color;  // linear
    float alpha;
    float roughness;  // perceptual
    float metallic;
    float occlusion;
    vec3 emissive;    // radiance
    bool unlit;
};

vec3 safe_normalize(vec3 v, vec3 otherwise) {
    float length2 = dot(v, v);
    return length2 > 1e-20 ? v * inversesqrt(length2) : otherwise;
}

// World-space shading normal. `texel`: the normal map's, 0..1 a channel.
vec3 shading_normal(vec3 texel) {
    vec3 normal = safe_normalize(vertex.normal, vec3(0.0, 1.0, 0.0));
#if NORMAL_MAP
    bool mapped = materials[vertex.material].textures[SLOT_NORMAL].array != NO_TEXTURE;
    if (mapped && dot(vertex.tangent.xyz, vertex.tangent.xyz) > 1e-20) {
        // MikkTSpace's own frame, which normal maps are baked for: unit at the vertices, then interpolated and neither
        // normalised nor orthogonalised; only the result is normalised.
        vec3 tangent = vertex.tangent.xyz;
        vec3 bitangent = cross(vertex.normal, tangent) * (vertex.tangent.w < 0.0 ? -1.0 : 1.0);
        float strength = materials[vertex.material].factors.z;
        vec3 n = (texel * 2.0 - 1.0) * vec3(strength, strength, 1.0);
        normal = safe_normalize(tangent * n.x + bitangent * n.y + vertex.normal * n.z, normal);
    }
#endif
    // Front faces are set per draw with mirrored transforms in mind, so gl_FrontFacing needs no correction.
#if BACK_FACES
    bool flip = (materials[vertex.material].flags & DOUBLE_SIDED) != 0u && !gl_FrontFacing;
    normal = flip ? -normal : normal;
#endif
    return normal;
}

Surface fetch_surface() {
    // A rolled loop over the textures the material has: five inlined fetches would cost five times the compilation, and
    // a software rasteriser runs both sides of a branch, but skips iterations.
    vec4 texels[5] = vec4[5](vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0), vec4(1.0));
#if TEXTURE_SLOTS == 1 // base colour alone: the loop would cost more than the fetch
    texels[SLOT_BASE_COLOR] = sample_material(SLOT_BASE_COLOR);
#elif TEXTURE_SLOTS
    uint pending = 0u;
    for (int slot = 0; slot < 5; ++slot) {
        if ((TEXTURE_SLOTS & (1 << slot)) != 0) {
            pending |= materials[vertex.material].textures[slot].array != NO_TEXTURE ? 1u << slot : 0u;
        }
    }
    do {
        int slot = findLSB(pending | 16u);
        pending &= pending - 1u;
        texels[slot] = sample_material(slot);
    } while (pending != 0u);
#endif
    vec4 base_color = material_base_color(texels[SLOT_BASE_COLOR]);
    vec4 factors = materials[vertex.material].factors;
    Surface s;
    s.normal = shading_normal(texels[SLOT_NORMAL].xyz);
    s.base_color = base_color.rgb;
    s.alpha = base_color.a;
    s.metallic = clamp(factors.x * texels[SLOT_METALLIC_ROUGHNESS].b, 0.0, 1.0);
    s.roughness = clamp(factors.y * texels[SLOT_METALLIC_ROUGHNESS].g, 0.0, 1.0);
    s.occlusion = 1.0 + factors.w * (texels[SLOT_OCCLUSION].r - 1.0);
    s.emissive = materials[vertex.material].emissive.rgb * texels[SLOT_EMISSIVE].rgb;
#if UNLIT_SURFACES
    s.unlit = (materials[vertex.material].flags & UNLIT) != 0u;
#else
    s.unlit = false;
#endif
    return s;
}
#endif

#endif
