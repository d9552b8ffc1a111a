// EACH(i) for every texture array of the scene: the body of a switch over constant sampler indices.
    EACH(0)
#if TEXTURE_ARRAYS > 1
    EACH(1)
#endif
#if TEXTURE_ARRAYS > 2
    EACH(2)
#endif
#if TEXTURE_ARRAYS > 3
    EACH(3)
#endif
#if TEXTURE_ARRAYS > 4
    EACH(4)
#endif
#if TEXTURE_ARRAYS > 5
    EACH(5)
#endif
#if TEXTURE_ARRAYS > 6
    EACH(6)
#endif
#if TEXTURE_ARRAYS > 7
    EACH(7)
#endif
