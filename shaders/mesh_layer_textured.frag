#version 450
#extension GL_GOOGLE_include_directive : require
#define LAYER
#define TEXTURED
#include "shaders/color.glsl"
