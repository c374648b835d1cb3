#version 450
#extension GL_GOOGLE_include_directive : require
#define LAYER
#define MAPPED
#define SHADOWED
#include "shaders/color.glsl"
