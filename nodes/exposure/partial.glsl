// What one work group of the average meter hands to the reduction: 8 bytes, std430.
struct Partial {
    float sum;   // of log2 luminances
    uint count;  // of finite texels
};
