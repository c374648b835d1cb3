// The radiance of the picture of the sky in a direction: that of the pixel in which the direction lies (SkyPicture).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(std430, push_constant) uniform Sky { SkyBlock sky; };
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_BASE_COLOR_TEXTURE) uniform sampler2D picture;

layout(location = 0) in vec3 in_direction;

layout(location = 0) out vec4 out_color;

const float kInversePi = 0.31830988618379067;

void main() {
  const ivec2 size = textureSize(picture, 0);
  const float azimuth = atan(in_direction.y, in_direction.x),
              elevation = atan(in_direction.z, length(in_direction.xy));
  const vec2 at = vec2(size) * (0.5 - kInversePi * vec2(0.5 * azimuth, elevation));
  const vec3 radiance = texelFetch(picture, clamp(ivec2(floor(at)), ivec2(0), size - 1), 0).rgb;
  out_color = vec4(sky.brightness.x * radiance, sky.brightness.y);
}
