#version 450
#extension GL_GOOGLE_include_directive : require
#define INSTANCE
#include "shaders/mesh_mask.glsl"
