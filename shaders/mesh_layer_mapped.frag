#version 450
#extension GL_GOOGLE_include_directive : require
#define LAYER
#define MAPPED
#include "shaders/color.glsl"
