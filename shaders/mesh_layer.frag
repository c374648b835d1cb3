#version 450
#extension GL_GOOGLE_include_directive : require
#define LAYER
#include "shaders/color.glsl"
