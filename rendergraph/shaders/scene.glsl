// The scene's instances, materials and textures. Layouts mirrored by rendergraph/scene/gpu_layout.py.
#ifndef SCENE_GLSL
#define SCENE_GLSL

// 128 bytes
struct Instance {
    mat4 world;          // object -> world
    vec4 normal_0;       // rows of the inverse transpose of world's 3x3 (xyz)
    vec4 normal_1;
    vec4 normal_2;
    uint material;       // index into Materials
    uint flags;          // 1: mirrored (negative determinant)
    uint object;         // stable id of the instance
    uint reserved;
};

// One texture reference, 32 bytes. array 0xffffffff: no texture.
struct TextureRef {
    uint array;          // index into u_textures
    uint layer;
    uint uv_set;         // 0 or 1
    uint wrap;           // bits 0-1: s, bits 2-3: t; 0 repeat, 1 clamp, 2 mirror
    vec4 transform;      // KHR_texture_transform: offset xy, scale xy  (rotation in Material.rotation)
};

// 256 bytes
struct Material {
    vec4 base_color;     // linear rgba factor
    vec4 emissive;       // linear rgb (strength multiplied in), w alpha cutoff
    vec4 factors;        // metallic, roughness, normal scale, occlusion strength
    uint flags;          // 1 masked, 2 blended, 4 double sided, 8 unlit
    uint reserved_0;
    uint reserved_1;
    uint reserved_2;
    vec4 rotation_0;     // texture rotations [rad]: base color, metallic-roughness, normal, occlusion
    vec4 rotation_1;     // emissive, unused
    TextureRef textures[5]; // base color (sRGB), metallic-roughness (g rough, b metal), normal, occlusion (r), emissive (sRGB)
};

const uint MIRRORED = 1u; // Instance.flags

const uint MASKED = 1u;   // Material.flags
const uint BLENDED = 2u;
const uint DOUBLE_SIDED = 4u;
const uint UNLIT = 8u;

layout(std430) readonly buffer Instances { Instance instances[]; };
layout(std430) readonly buffer Materials { Material materials[]; };

#endif
