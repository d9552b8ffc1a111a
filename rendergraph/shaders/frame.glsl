// The frame's constants: one std140 block, written before the first frame. Layout mirrored by rendergraph/run/frame_constants.py.
#ifndef FRAME_GLSL
#define FRAME_GLSL

layout(std140) uniform Frame {
    mat4 view;                  // world -> view
    mat4 projection;            // view -> clip, z in 0..1
    mat4 view_projection;       // world -> clip
    mat4 inverse_view;
    mat4 inverse_projection;
    mat4 inverse_view_projection;
    mat4 previous_view_projection; // last frame's; this frame's on frame 0
    vec4 camera;                // xyz world position [m], w near plane distance [m]
    vec4 viewport;              // width, height [px], 1/width, 1/height
    vec4 sun_direction;         // xyz unit vector TOWARDS the sun, w far plane distance [m], 0 for infinity
    vec4 sun_irradiance;        // rgb irradiance of a surface facing the sun, w unused
    vec4 ambient_sky;           // rgb radiance from above
    vec4 ambient_ground;        // rgb radiance from below
    vec4 scene_min;             // xyz world bounds [m]
    vec4 scene_max;
    uvec4 counts;               // frame index, seed, number of lights, number of instances
} frame;

#endif
