// Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight", appendix A.2: luminance Y and
// chromaticities x and y of a clear sky, each its zenith value times a ratio of Perez functions.
#ifndef PREETHAM_GLSL
#define PREETHAM_GLSL

// The five coefficients of (x, y, Y): the shape of the sky at this turbidity.
struct Perez {
    vec3 a, b, c, d, e;
};

Perez perez_coefficients(float t) {
    return Perez(
        t * vec3(-0.0193, -0.0167, 0.1787) + vec3(-0.2592, -0.2608, -1.4630),
        t * vec3(-0.0665, -0.0950, -0.3554) + vec3(0.0008, 0.0092, 0.4275),
        t * vec3(-0.0004, -0.0079, -0.0227) + vec3(0.2125, 0.2102, 5.3251),
        t * vec3(-0.0641, -0.0441, 0.1206) + vec3(-0.8989, -1.6537, -2.5771),
        t * vec3(-0.0033, -0.0109, -0.0670) + vec3(0.0452, 0.0529, 0.3703)
    );
}

// `cos_zenith` of the direction seen, `gamma` [rad] between it and the sun.
vec3 perez(Perez p, float cos_zenith, float gamma) {
    float cos_gamma = cos(gamma);
    return (1.0 + p.a * exp(p.b / cos_zenith)) * (1.0 + p.c * exp(p.d * gamma) + p.e * cos_gamma * cos_gamma);
}

// (x, y, Y [kcd/m^2]) straight up, for the sun `theta` [rad] from the zenith.
vec3 zenith(float theta, float t) {
    vec4 powers = vec4(theta * theta * theta, theta * theta, theta, 1.0);
    vec3 haze = vec3(t * t, t, 1.0);
    vec3 x = vec3(
        dot(powers, vec4(0.00166, -0.00375, 0.00209, 0.0)),
        dot(powers, vec4(-0.02903, 0.06377, -0.03202, 0.00394)),
        dot(powers, vec4(0.11693, -0.21196, 0.06052, 0.25886))
    );
    vec3 y = vec3(
        dot(powers, vec4(0.00275, -0.00610, 0.00317, 0.0)),
        dot(powers, vec4(-0.04214, 0.08970, -0.04153, 0.00516)),
        dot(powers, vec4(0.15346, -0.26756, 0.06670, 0.26688))
    );
    float chi = (4.0 / 9.0 - t / 120.0) * (3.14159265358979 - 2.0 * theta);
    float luminance = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
    return vec3(dot(haze, x), dot(haze, y), max(luminance, 0.0));
}

// Linear Rec. 709 (D65) of a chromaticity and luminance; colours outside the gamut are clipped to it.
vec3 rec709(vec3 xyY) {
    vec3 xyz = vec3(xyY.x, xyY.y, 1.0 - xyY.x - xyY.y) * (xyY.z / xyY.y);
    const mat3 to_rgb = mat3(
        3.2404542, -0.9692660, 0.0556434,
        -1.5371385, 1.8760108, -0.2040259,
        -0.4985314, 0.0415560, 1.0572252
    );
    return max(to_rgb * xyz, 0.0);
}

// Radiance [kcd/m^2] from a unit direction, `sun` the unit vector towards the sun, `t` the turbidity. The model ends at
// the horizon: directions and suns below it are taken as on it.
vec3 preetham(vec3 direction, vec3 sun, float t) {
    Perez p = perez_coefficients(t);
    // Angles by their tangents: the cosine alone loses a small one, and acos() is the least exact function of drivers.
    float theta = atan(length(sun.xz), max(sun.y, 0.0));
    float gamma = atan(length(cross(direction, sun)), dot(direction, sun));
    vec3 ratio = perez(p, max(direction.y, 1.0e-3), gamma) / perez(p, 1.0, theta);
    return rec709(zenith(theta, t) * ratio);
}

#endif
