// What scene.vert hands to a fragment shader. Define VARYING as `out` or `in` before including.
//
//   SECOND_UV      0: no texture uses the second texture coordinates
//   VERTEX_COLORS  0: all vertices are white
#ifndef SECOND_UV
#define SECOND_UV 1
#endif
#ifndef VERTEX_COLORS
#define VERTEX_COLORS 1
#endif

VARYING Vertex {
#if !DEPTH_ONLY
    vec3 normal;     // world; unit at the vertices, not between them
    vec4 tangent;    // world; likewise; w: handedness of the bitangent in world space
#endif
    vec2 uv0;
#if SECOND_UV
    vec2 uv1;
#endif
#if VERTEX_COLORS
    vec4 color;      // linear
#endif
    flat uint material;
} vertex;
