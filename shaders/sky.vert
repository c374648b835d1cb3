// The triangle that shows the picture of the sky in all of a view, behind everything that has a depth.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(std430, push_constant) uniform Sky { SkyBlock sky; };

layout(location = 0) out vec3 out_direction;  // in the picture's frame, of any length

void main() {
  const vec3 at = vec3(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0, 1.0);
  out_direction = vec3(dot(sky.row_x.xyz, at), dot(sky.row_y.xyz, at), dot(sky.row_z.xyz, at));
  gl_Position = vec4(at.xy, 0.0, 1.0);
}
