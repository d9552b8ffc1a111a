// The one surface model: Lambert diffuse under GGX specular, metallic-roughness parameters.
//
// GGX: Walter et al. 2007. Height-correlated Smith masking and shadowing: Heitz 2014 (JCGT 3(2)). Fresnel: Schlick 1994.
#ifndef BRDF_GLSL
#define BRDF_GLSL

const float PI = 3.14159265358979;
const float DIELECTRIC_F0 = 0.04; // index of refraction 1.5
const float MIN_ALPHA = 0.002;    // keeps the peak of D, 1 / (pi alpha^2), inside float32 with room for bright lights
const float MIN_NOV = 1e-4;       // shading normals may face away from the eye; masking is singular at grazing
const float SMALLEST = 1.2e-38;   // the smallest normal float32

// What the surface model needs of a point, computed once for all lights.
struct Brdf {
    vec3 normal;
    vec3 view;      // unit vector to the eye
    vec3 albedo;    // of the Lambert part
    vec3 lambert;   // albedo / pi
    vec3 f0;
    float alpha;
    float alpha2;
    float nov;
    float root;     // Smith's, of the view direction
};

// Smith's square root for one direction; masking alone is G1 = 2 cosine / (cosine + root).
float smith_root(float cosine, float alpha2) {
    return sqrt(cosine * cosine * (1.0 - alpha2) + alpha2);
}

Brdf make_brdf(vec3 normal, vec3 view, vec3 base_color, float roughness, float metallic) {
    Brdf b;
    b.normal = normal;
    b.view = view;
    b.albedo = base_color * (1.0 - metallic);
    b.lambert = b.albedo / PI;
    b.f0 = mix(vec3(DIELECTRIC_F0), base_color, metallic);
    b.alpha = max(roughness * roughness, MIN_ALPHA);
    b.alpha2 = b.alpha * b.alpha;
    b.nov = max(dot(normal, view), MIN_NOV);
    b.root = smith_root(b.nov, b.alpha2);
    return b;
}

vec3 schlick_fresnel(vec3 f0, float cosine) {
    float m = clamp(1.0 - cosine, 0.0, 1.0);
    float m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}

// Reflected radiance per irradiance on a facing surface: f(L, V) * NoL. `light` is a unit vector, or zero for a light
// that lies exactly on the surface, which gives zero.
//
// The half vector H is never normalised: with S = L + V, NoH = N.S / |S| and LoH = |S| / 2, and distribution and
// visibility are one quotient, D G / (4 NoL NoV) = alpha^2 |S|^4 / (2 pi q^2 s), where q = |N x S|^2 + (alpha N.S)^2 and
// s = 2 NoL NoV / G. 1 - NoH^2 is taken as |N x H|^2: near the peak the difference would cancel, and at alpha = 0.002 the
// float32 error of NoH alone would be a few percent of the result.
vec3 evaluate_brdf(Brdf b, vec3 light) {
    float nol = clamp(dot(b.normal, light), 0.0, 1.0);
    vec3 sum = light + b.view;
    float length2 = dot(sum, sum);
    vec3 c = cross(b.normal, sum);
    float a = b.alpha * dot(b.normal, sum);
    float q = dot(c, c) + a * a;
    float s = b.nov * smith_root(nol, b.alpha2) + nol * b.root;
    float k = b.alpha * length2;
    // L = -V leaves no half vector: nothing is reflected rather than 0 / 0.
    float specular = (0.5 / PI) * k * k / max(q * q * s, SMALLEST);
    vec3 fresnel = schlick_fresnel(b.f0, 0.5 * sqrt(length2));
    return (b.lambert + fresnel * (specular - b.lambert)) * nol;
}

// Share of constant light from all around that the specular lobe reflects: f0 * A + B, both a quotient of quadratics in
// NoV and roughness, fitted to the integral (deferred_lighting/reference.py) to within 0.041 and 0.020.
vec3 environment_reflectance(Brdf b, float roughness) {
    float x = b.nov;
    float r = roughness;
    vec2 above = vec2(-0.069, 1.029) + vec2(3.392, 0.489) * x + vec2(1.849, -0.071) * r
        + vec2(-20.789, -2.120) * x * r + vec2(39.548, -2.407) * x * x + vec2(0.031, -0.650) * r * r
        + vec2(-39.706, 2.220) * x * x * r + vec2(19.731, 2.379) * x * r * r;
    vec2 below = vec2(1.0) + vec2(4.867, 3.994) * x + vec2(-0.626, 2.312) * r
        + vec2(-25.981, -57.420) * x * r + vec2(35.452, 45.577) * x * x + vec2(1.719, 7.051) * r * r
        + vec2(-28.935, -3.433) * x * x * r + vec2(26.371, 158.247) * x * r * r;
    vec2 fit = clamp(above / below, 0.0, 1.0);
    return min(b.f0 * fit.x + fit.y, 1.0);
}

#endif
