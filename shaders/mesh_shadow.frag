#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/shadow_depth.glsl"

void main() { gl_FragDepth = shadow_depth(); }
