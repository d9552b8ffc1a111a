"""OpenGL 4.5 on EGL: context, textures, buffers, framebuffers, programs, clocks; the only package that calls GL."""
