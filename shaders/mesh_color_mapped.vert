#version 450
#extension GL_GOOGLE_include_directive : require
#define MAPPED
#include "shaders/mesh_color.glsl"
