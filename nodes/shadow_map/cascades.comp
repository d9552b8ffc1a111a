#version 450
// Fits one sphere around each slice of the view frustum and looks at it from the sun: one invocation a cascade.
//
// A sphere keeps its size when the camera turns, and its centre moves in whole texels, so a shadow's edge falls on the
// same texels from frame to frame: no shimmer (Valient, "Stable rendering of cascaded shadow maps", ShaderX6, 2008).
// Splits between uniform and logarithmic: Zhang et al., "Parallel-split shadow maps", 2006; Engel, ShaderX5, 2006;
// Dimitrov, "Cascaded shadow maps", NVIDIA, 2007.
#define CASCADES_ACCESS writeonly
#include <frame.glsl>
#include <cascades.glsl>

layout(local_size_x = 4) in;

uniform int u_count;
uniform float u_distance;    // [m]
uniform float u_split;       // 0 uniform .. 1 logarithmic
uniform float u_resolution;  // texels a side
uniform float u_normal_bias; // filter radii

const float PAD = 6.0; // texels kept free around the sphere, for the filter and the snapping

// Near and far view depth [m] of the range to split. It hugs the scene's bounding sphere, but in coarse steps (a quarter
// of an octave): a range that followed the camera exactly would rescale the cascades every frame.
vec2 shadow_range() {
    vec3 centre = 0.5 * (frame.scene_min.xyz + frame.scene_max.xyz);
    float radius = 0.5 * distance(frame.scene_min.xyz, frame.scene_max.xyz);
    float eye = distance(frame.camera.xyz, centre);
    float near = frame.camera.w;
    float nearest = exp2(floor(log2(max(eye - radius, near)) * 4.0) * 0.25);
    float farthest = exp2(ceil(log2(max(eye + radius, near)) * 4.0) * 0.25);
    float far = min(u_distance, farthest);
    if (frame.sun_direction.w > 0.0) {
        far = min(far, frame.sun_direction.w);
    }
    // The view depth of a point is less than its distance away from the axis, by the cosine of the corner's angle.
    vec2 tangent = vec2(1.0 / frame.projection[0][0], 1.0 / frame.projection[1][1]);
    near = max(near, nearest * inversesqrt(1.0 + dot(tangent, tangent)));
    return vec2(min(near, 0.5 * far), far);
}

float split_depth(vec2 range, float fraction) {
    return mix(mix(range.x, range.y, fraction), range.x * pow(range.y / range.x, fraction), u_split);
}

// Smallest sphere around the frustum between two view depths: x the distance of its centre, y its radius [m].
vec2 slice_sphere(float near, float far) {
    vec2 tangent = vec2(1.0 / frame.projection[0][0], 1.0 / frame.projection[1][1]);
    float k = dot(tangent, tangent);
    // Equally far from near and far corners; a wide slice is bounded by its far rectangle alone.
    float centre = min(0.5 * (near + far) * (1.0 + k), far);
    return vec2(centre, length(vec2(far - centre, far * sqrt(k))));
}

void main() {
    uint index = gl_LocalInvocationID.x;
    if (index == 0u) {
        cascades.count = uint(u_count);
        cascades.normal_bias = u_normal_bias;
        cascades.unused_0 = 0u;
        cascades.unused_1 = 0u;
    }
    vec2 range = shadow_range();
    bool used = index < uint(u_count);
    float near = split_depth(range, float(index) / float(u_count));
    float far = index + 1u == uint(u_count) ? range.y : split_depth(range, float(index + 1u) / float(u_count));
    vec2 sphere = slice_sphere(near, far);
    // Rounding of the camera's matrices must not change the texel size from frame to frame.
    float grain = exp2(floor(log2(sphere.y)) - 10.0);
    float radius = ceil(sphere.y / grain) * grain * u_resolution / max(u_resolution - 2.0 * PAD, 1.0);
    float texel = 2.0 * radius / u_resolution;

    // Right-handed: x right, y up, z towards the sun. Fixed while the sun is.
    vec3 z = frame.sun_direction.xyz;
    vec3 x = normalize(cross(abs(z.y) < 0.99 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), z));
    vec3 y = cross(z, x);
    vec3 eye_axis = -frame.inverse_view[2].xyz;
    vec3 world = frame.camera.xyz + eye_axis * sphere.x;
    vec3 centre = vec3(dot(x, world), dot(y, world), dot(z, world));
    centre.xy = floor(centre.xy / texel + 0.5) * texel;

    float inverse = 1.0 / radius;
    // z: 1 nearest to the sun under reversed depth, 0 under standard.
#if DEPTH_REVERSED
    vec3 depth_row = 0.5 * inverse * z;
    float depth_offset = 0.5 - 0.5 * inverse * centre.z;
#else
    vec3 depth_row = -0.5 * inverse * z;
    float depth_offset = 0.5 + 0.5 * inverse * centre.z;
#endif
    mat4 rows = mat4(
        vec4(x * inverse, -centre.x * inverse),
        vec4(y * inverse, -centre.y * inverse),
        vec4(depth_row, depth_offset),
        vec4(0.0, 0.0, 0.0, 1.0)
    );
    cascades.to_clip[index] = used ? transpose(rows) : mat4(0.0);
    cascades.far[index] = used ? far : 0.0;
    cascades.texel[index] = used ? texel : 0.0;
}
