// The mean of all samples of each pixel. The samples are summed in pairs, pairs of pairs and so on: the order is always
// the same, and equal samples give exactly their value. MULTISAMPLED is defined if texels have several samples.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "shaders/interop.h"

// Part of a row: the processor of a CPU device prefetches memory that is read in order, and the mean is bound by memory.
layout(local_size_x = SIMVIS_RESOLVE_GROUP) in;
layout(constant_id = SIMVIS_RESOLVE_SUPERSAMPLING) const int kSupersampling = 1;
layout(constant_id = SIMVIS_RESOLVE_MSAA) const int kMsaa = 1;

#ifdef MULTISAMPLED
layout(set = 0, binding = SIMVIS_RESOLVE_SAMPLES) uniform texture2DMS samples;
#else
layout(set = 0, binding = SIMVIS_RESOLVE_SAMPLES) uniform texture2D samples;
#endif
layout(set = 0, binding = SIMVIS_RESOLVE_MEAN, rgba32f) writeonly uniform image2D mean;

vec4 one(ivec2 texel, int s) { return texelFetch(samples, texel, s); }
vec4 two(ivec2 texel, int s) { return one(texel, s) + one(texel, s + 1); }
vec4 four(ivec2 texel, int s) { return two(texel, s) + two(texel, s + 2); }

vec4 of_texel(ivec2 texel) {
  if (kMsaa == 1) return one(texel, 0);
  if (kMsaa == 2) return two(texel, 0);
  if (kMsaa == 4) return four(texel, 0);
  return four(texel, 0) + four(texel, 4);
}

vec4 of_quad(ivec2 texel) {
  return (of_texel(texel) + of_texel(texel + ivec2(1, 0))) +
         (of_texel(texel + ivec2(0, 1)) + of_texel(texel + ivec2(1, 1)));
}

vec4 of_pixel(ivec2 texel) {
  if (kSupersampling == 1) return of_texel(texel);
  if (kSupersampling == 2) return of_quad(texel);
  return (of_quad(texel) + of_quad(texel + ivec2(2, 0))) +
         (of_quad(texel + ivec2(0, 2)) + of_quad(texel + ivec2(2, 2)));
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(mean)))) return;
  // The divisor is a power of two, so the division does not round.
  imageStore(mean, pixel, of_pixel(pixel * kSupersampling) / float(kSupersampling * kSupersampling * kMsaa));
}
