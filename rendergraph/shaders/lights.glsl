// Local lights. Layout mirrored by rendergraph/scene/gpu_layout.py.
#ifndef LIGHTS_GLSL
#define LIGHTS_GLSL

// 64 bytes
struct Light {
    vec4 position_radius;  // xyz world [m], w reach [m]: exactly dark at and beyond it
    vec4 intensity;        // rgb radiant intensity, w minimum distance d0 [m]
    vec4 axis_outer;       // spot: xyz unit axis (the way the light travels), w cos(outer half angle); points: w = -2
    vec4 inner;            // x cos(inner half angle), yzw unused
};

layout(std430) readonly buffer Lights { Light lights[]; };

#endif
