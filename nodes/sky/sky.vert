#version 450
// One triangle exactly on the far plane: it passes a closer-or-equal test only where depth was cleared to the far plane.
#include <frame.glsl>

out vec3 v_ray;  // world-space direction of the view ray, not normalised

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    float far = DEPTH_REVERSED != 0 ? 0.0 : 1.0;
    gl_Position = vec4(corner, far, 1.0);
    // Unprojected at the near plane and in view space: the far plane may be infinitely far, and the camera may be so
    // far from the origin that subtracting its position would lose the direction.
    vec4 near = frame.inverse_projection * vec4(corner, 1.0 - far, 1.0);
    v_ray = mat3(frame.inverse_view) * (near.xyz / near.w);
}
