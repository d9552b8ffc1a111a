// The ground half of every model, and the blend across the horizon.
#include <frame.glsl>

uniform float u_horizon;  // sine of the elevation over which the halves blend

// Radiance of the ground below and `above` over it, for a unit direction.
vec3 with_ground(vec3 above, vec3 direction) {
    return mix(frame.ambient_ground.rgb, above, smoothstep(-u_horizon, u_horizon, direction.y));
}
