// What scene.vert hands to a fragment shader. Define VARYING as `out` or `in` before including.
VARYING Vertex {
#if !DEPTH_ONLY
    vec3 normal;     // world; unit at the vertices, not between them
    vec4 tangent;    // world; likewise; w: handedness of the bitangent in world space
#endif
    vec2 uv0;
    vec2 uv1;
    vec4 color;      // linear
    flat uint material;
} vertex;
