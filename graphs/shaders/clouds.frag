#version 450
// A sky of cumulus clouds: single scattering through a layer of value noise, marched along every pixel's ray. Costly on
// purpose; the clouds are soft, so a quarter of the pixels shows nearly as much.
#include <frame.glsl>

uniform int u_steps;         // samples of the layer along a ray
uniform float u_wind;        // metres a frame

in vec2 v_uv;
out vec4 color;              // premultiplied linear radiance, coverage in alpha

const float BASE = 900.0, TOP = 1900.0;              // the layer, metres above the eye
const vec3 TO_SUN = vec3(0.36, 0.48, 0.8);

// PCG (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 2020).
float lattice(ivec3 cell) {
    uvec3 v = uvec3(cell) * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    return float(v.x >> 8u) * (1.0 / 16777216.0);
}

float noise(vec3 p) {
    ivec3 cell = ivec3(floor(p));
    vec3 f = p - vec3(cell);
    f = f * f * (3.0 - 2.0 * f);
    vec4 low = vec4(lattice(cell), lattice(cell + ivec3(1, 0, 0)), lattice(cell + ivec3(0, 1, 0)), lattice(cell + ivec3(1, 1, 0)));
    vec4 high = vec4(
        lattice(cell + ivec3(0, 0, 1)), lattice(cell + ivec3(1, 0, 1)), lattice(cell + ivec3(0, 1, 1)), lattice(cell + ivec3(1, 1, 1))
    );
    vec4 x = mix(low, high, f.z);
    vec2 y = mix(x.xz, x.yw, f.x);
    return mix(y.x, y.y, f.y);
}

// 0 outside clouds, up to 1 inside.
float density(vec3 p) {
    vec3 q = p * 0.0011 + vec3(u_wind * float(frame.counts.x) * 0.0011, 0.0, 0.0);
    float sum = 0.0, weight = 0.55;
    for (int octave = 0; octave < 3; ++octave) {
        sum += weight * noise(q);
        q = q * 2.13 + 7.7;
        weight *= 0.5;
    }
    float height = (p.y - BASE) / (TOP - BASE);
    float shape = smoothstep(0.0, 0.25, height) * smoothstep(1.0, 0.45, height);
    return clamp((sum * shape - 0.36) * 3.2, 0.0, 1.0);
}

void main() {
    vec2 p = (v_uv - vec2(0.5, 0.12)) * vec2(frame.viewport.x * frame.viewport.w, 1.0);
    vec3 ray = normalize(vec3(p.x, max(p.y, 0.02) + 0.05, 1.1));
    float start = BASE / ray.y, end = min(TOP / ray.y, 16000.0);
    float step_length = max(end - start, 0.0) / float(u_steps);
    float clear = 1.0;
    vec3 light = vec3(0.0);
    for (int i = 0; i < u_steps; ++i) {
        vec3 at = ray * (start + (float(i) + 0.5) * step_length);
        float here = density(at);
        if (here > 0.0) {
            float shade = exp(-2.2 * density(at + TO_SUN * 170.0));
            vec3 lit = vec3(1.15, 1.08, 0.98) * shade + vec3(0.28, 0.34, 0.44);
            float kept = exp(-here * step_length * 0.006);
            light += clear * (1.0 - kept) * lit;
            clear *= kept;
        }
    }
    float haze = smoothstep(15000.0, 5000.0, start);
    color = vec4(light, 1.0 - clear) * haze;
}
