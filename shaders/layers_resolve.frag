// What a sample's transparent surfaces show together, nearest first, and through how much of them what is behind is
// seen (alpha): Porter and Duff's "over". Surfaces at one depth follow each other by the bits of their colours, so that
// in which order they were drawn does not show.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/layers.glsl"

layout(location = 0) out vec4 out_color;

// Depth is reversed and positive: its bits grow towards the eye.
bool is_before(LayerNode a, LayerNode b) {
  if (a.place.x != b.place.x) return a.place.x > b.place.x;
  const uvec4 p = floatBitsToUint(a.color), q = floatBitsToUint(b.color);
  if (p.r != q.r) return p.r > q.r;
  if (p.g != q.g) return p.g > q.g;
  if (p.b != q.b) return p.b > q.b;
  return p.a > q.a;
}

void main() {
  const uint first = lists.first[list_here()];
  if (first == 0u) discard;
  vec3 seen = vec3(0.0);
  float through = 1.0;
  LayerNode last, next;
  bool begun = false;
  while (through > 0.0) {
    // The first of those that come after the last one, and how many are equal to it.
    uint count = 0u;
    for (uint n = first; n != 0u;) {
      const LayerNode node = nodes[n - 1u];
      n = node.place.y;
      if (begun && !is_before(last, node)) continue;
      if (count == 0u || is_before(node, next)) {
        next = node;
        count = 1u;
      } else if (!is_before(next, node)) {
        ++count;
      }
    }
    if (count == 0u) break;
    for (; count > 0u; --count) {
      seen += (through * next.color.a) * next.color.rgb;
      through *= 1.0 - next.color.a;
    }
    last = next;
    begun = true;
  }
  out_color = vec4(seen, through);
}
