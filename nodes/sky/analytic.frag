#version 450
// Preetham's daylight above the horizon, fading to the ambient gradient in twilight, with the sun's disc.
#include "horizon.glsl"
#include <colour.glsl>
#include "preetham.glsl"

uniform float u_turbidity;
uniform float u_sun_illuminance;  // [klx] that the scene's sun irradiance stands for
uniform float u_sun_radius;       // [rad]

in vec3 v_ray;
out vec4 out_color;

const float PI = 3.14159265358979;
const float TWILIGHT = -0.10452846;  // sine of -6 degrees: the end of civil twilight
const float CEILING = 64512.0;       // largest value that every floating-point target format holds

// Share of the pixel that the disc covers, its edge a ramp as wide as a pixel. A disc smaller than a pixel is drawn as
// large as one. The ramp spreads a disc of radius r over pi (r^2 + pixel^2 / 12): divided by that, its light stays the same.
float disc_coverage(vec3 direction, vec3 sun) {
    float pixel = 2.0 * frame.viewport.w / frame.projection[1][1];  // [rad] at the centre of the view
    // By the chord, and the arcsine by its series: the cosine, and Mesa's asin(), lose digits at so small an angle.
    float chord = length(direction - sun);
    float square = chord * chord;
    float angle = chord * (1.0 + square / 24.0 * (1.0 + square * 9.0 / 80.0));
    float radius = max(u_sun_radius, 0.5 * pixel);
    float spread = (radius * radius + pixel * pixel / 12.0) / (u_sun_radius * u_sun_radius);
    return clamp((radius - angle) / pixel + 0.5, 0.0, 1.0) / spread;
}

void main() {
    vec3 direction = normalize(v_ray);
    vec3 sun = frame.sun_direction.xyz;
    vec3 irradiance = frame.sun_irradiance.rgb;
    float strength = luminance(irradiance);
    vec3 above = frame.ambient_sky.rgb;
    vec3 disc = vec3(0.0);
    if (strength > 0.0 && sun.y > TWILIGHT) {
        vec3 daylight = preetham(direction, sun, u_turbidity) * (strength / u_sun_illuminance);
        above = mix(above, daylight, smoothstep(TWILIGHT, 0.0, sun.y));
        if (u_sun_radius > 0.0) {
            // The radiance whose disc gives a surface facing it the sun's irradiance.
            float sine = sin(u_sun_radius);
            disc = irradiance / (PI * sine * sine) * disc_coverage(direction, sun) * step(0.0, direction.y);
        }
    }
    out_color = vec4(min(with_ground(above, direction) + disc, CEILING), 1.0);
}
