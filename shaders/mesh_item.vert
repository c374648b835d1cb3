// Depth and item of opaque surfaces; reads positions only.
#version 450
#extension GL_GOOGLE_include_directive : require
#define ITEM
#include "shaders/mesh.glsl"

void main() {
  place_vertex();
  out_item = instance_item;
}
