// OIT layers of a band of rows, one linked list for each sample: see engine/render/oit_buffer.h.
#extension GL_GOOGLE_include_directive : require
#include "shaders/interop.h"

layout(std430, set = SIMVIS_LAYERS_SET, binding = SIMVIS_LAYER_LISTS) buffer LayerLists {
  LayerBand band;
  uint first[];  // first layer of the list of each sample, counted from 1; 0 if the list is empty
} lists;
layout(std430, set = SIMVIS_LAYERS_SET, binding = SIMVIS_LAYER_NODES) buffer LayerNodes { LayerNode nodes[]; };

uint list_here() {
  const uvec2 texel = uvec2(gl_FragCoord.xy);
  const uvec4 rows = lists.band.rows;
  return ((texel.y - rows.z) * rows.y + texel.x) * rows.w + uint(gl_SampleID);
}

// Layers that do not fit into the buffer are counted as well: the host then draws the frame again with more memory.
void add_layer(vec4 color) {
  if (!(color.a > 0.0)) return;
  const uint node = atomicAdd(lists.band.rows.x, 1u) + 1u;
  if (node > uint(nodes.length())) return;
  const uint next = atomicExchange(lists.first[list_here()], node);
  nodes[node - 1u].color = color;
  nodes[node - 1u].place.xy = uvec2(floatBitsToUint(gl_FragCoord.z), next);
}
