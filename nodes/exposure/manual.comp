#version 450
// No meter: middle grey stays where it is, and the compensation alone scales the image.
#include "adapt.glsl"

layout(local_size_x = 1) in;

void main() {
    write_exposure(LOG_MIDDLE_GREY, 0u);
}
