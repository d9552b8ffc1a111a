// The sun's shadow cascades: 320 bytes, written by shadow_map/cascades.comp.
#ifndef CASCADES_GLSL
#define CASCADES_GLSL

#ifndef CASCADES_ACCESS
#define CASCADES_ACCESS readonly
#endif

layout(std430) CASCADES_ACCESS buffer Cascades {
    mat4 to_clip[4];  // world -> the map's clip space; z follows the frame's depth convention
    vec4 far;         // view depth at which each cascade ends [m]
    vec4 texel;       // width of a texel [m]
    uint count;
    float normal_bias; // receiver offset along the normal, in filter radii
    uint unused_0;
    uint unused_1;
} cascades;

#endif
