#version 450
#extension GL_GOOGLE_include_directive : require
#define SHADOWED
#define TEXTURED
#include "shaders/color.glsl"
