#version 450
// The scene's ambient hemisphere as the lighting sees it: one radiance above, one below.
#include "horizon.glsl"

in vec3 v_ray;
out vec4 out_color;

void main() {
    out_color = vec4(with_ground(frame.ambient_sky.rgb, normalize(v_ray)), 1.0);
}
