// The sun's shadow cascades: 320 bytes, written by shadow_map/cascades.comp.
#ifndef CASCADES_GLSL
#define CASCADES_GLSL

#ifndef CASCADES_ACCESS
#define CASCADES_ACCESS readonly
#endif

layout(std430) CASCADES_ACCESS buffer Cascades {
    mat4 to_clip[4];  // world -> the map's clip space; z follows the frame's depth convention
    // Arrays, not vectors: each invocation writes its own element, and a driver may write a whole vector for one component.
    float far[4];     // view depth at which each cascade ends [m]
    float texel[4];   // width of a texel [m]
    uint count;
    float normal_bias; // receiver offset along the normal, in filter radii
    uint unused_0;
    uint unused_1;
} cascades;

#endif
