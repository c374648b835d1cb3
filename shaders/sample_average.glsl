// The mean of all samples of each pixel, in a fixed order: so that it is the same bytes on every run.
// MULTISAMPLED is defined where the texels themselves have samples.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "shaders/interop.h"

layout(local_size_x = SIMVIS_AVERAGE_GROUP, local_size_y = SIMVIS_AVERAGE_GROUP) in;
layout(constant_id = SIMVIS_AVERAGE_GRID) const int kGrid = 1;
layout(constant_id = SIMVIS_AVERAGE_MSAA) const int kMsaa = 1;

#ifdef MULTISAMPLED
layout(set = 0, binding = SIMVIS_AVERAGE_SAMPLES) uniform texture2DMS samples;
#else
layout(set = 0, binding = SIMVIS_AVERAGE_SAMPLES) uniform texture2D samples;
#endif
layout(set = 0, binding = SIMVIS_AVERAGE_MEAN, rgba32f) writeonly uniform image2D mean;

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(mean)))) return;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < kGrid; ++y) {
    for (int x = 0; x < kGrid; ++x) {
      for (int s = 0; s < kMsaa; ++s) sum += texelFetch(samples, pixel * kGrid + ivec2(x, y), s);
    }
  }
  // A power of two: this division does not round.
  imageStore(mean, pixel, sum / float(kGrid * kGrid * kMsaa));
}
