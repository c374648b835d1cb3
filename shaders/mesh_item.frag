// Writes the item of an opaque surface.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(location = SIMVIS_ITEM) flat in uint in_item;
layout(location = 0) out uint out_item;

void main() { out_item = in_item; }
