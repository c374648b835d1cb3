// Discards the fragments whose alpha is below the cutoff. TEXTURED is defined if the material has a texture, SHADOW_MAP
// if the depth is that of a shadow map, ITEM if the item is written, INSTANCE if alpha holds the number of the instance.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

#ifdef TEXTURED
layout(set = SIMVIS_TEXTURE_SET, binding = SIMVIS_BASE_COLOR_TEXTURE) uniform sampler2D base_color_texture;
#endif

layout(location = 0) in vec2 in_uv;
layout(location = 1) in float in_alpha;
layout(location = 2) flat in float in_cutoff;
#ifdef ITEM
layout(location = SIMVIS_ITEM) flat in uint in_item;
layout(location = 0) out uint out_item;
#endif

#ifdef INSTANCE
layout(location = SIMVIS_ITEM) flat in uint in_instance;
layout(location = 0) out vec4 out_color;
#endif

#ifdef SHADOW_MAP
#include "shaders/shadow_depth.glsl"
#endif

void main() {
#ifdef SHADOW_MAP
  gl_FragDepth = shadow_depth();  // before the discard: fwidth() needs the neighbours
#endif
  float alpha = in_alpha;
#ifdef TEXTURED
  alpha *= textureLod(base_color_texture, in_uv, 0).a;  // the largest level, as for rays: pixels are independent
#endif
  if (alpha < in_cutoff) discard;
#ifdef ITEM
  out_item = in_item;
#endif
#ifdef INSTANCE
  out_color = vec4(0.0, 0.0, 0.0, uintBitsToFloat(SIMVIS_INSTANCE_0 + in_instance));
#endif
}
