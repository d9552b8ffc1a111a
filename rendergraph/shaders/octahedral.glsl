// Octahedral map: a unit vector to a square and back (Cigolle et al. 2014, JCGT 3(2)).
#ifndef OCTAHEDRAL_GLSL
#define OCTAHEDRAL_GLSL

// Like sign(), but +1 at zero: sign(0) = 0 would fold the -z pole onto +z.
vec2 sign_not_zero(vec2 v) {
    return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0);
}

// Unit vector to [-1, 1]^2. The zero vector goes to the centre, which decodes as +z.
vec2 octahedral_encode(vec3 n) {
    vec3 p = n / max(abs(n.x) + abs(n.y) + abs(n.z), 1e-20);
    return p.z >= 0.0 ? p.xy : (1.0 - abs(p.yx)) * sign_not_zero(p.xy);
}

// [-1, 1]^2 to a unit vector.
vec3 octahedral_decode(vec2 e) {
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    if (n.z < 0.0) {
        n.xy = (1.0 - abs(n.yx)) * sign_not_zero(n.xy);
    }
    return normalize(n);
}

#endif
