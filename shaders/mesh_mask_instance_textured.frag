#version 450
#extension GL_GOOGLE_include_directive : require
#define INSTANCE
#define TEXTURED
#include "shaders/mask.glsl"
