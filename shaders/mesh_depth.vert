// Depth of opaque surfaces: positions and nothing else.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/mesh.glsl"

void main() { place_vertex(); }
