// Composites the transparent surfaces of a sample from the nearest to the farthest with Porter and Duff's "over"
// operator. The output alpha is the transmittance for everything behind them. Surfaces at the same depth are sorted by
// the bits of their colours, so that the result does not depend on the order in which they were drawn.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "shaders/layers.glsl"

layout(location = 0) out vec4 out_color;

vec3 seen = vec3(0.0);
float through = 1.0;

void lay(vec4 color) {
  seen += (through * color.a) * color.rgb;
  through *= 1.0 - color.a;
}

bool is_before(uvec4 a, uvec4 b) {
  if (a.r != b.r) return a.r > b.r;
  if (a.g != b.g) return a.g > b.g;
  if (a.b != b.b) return a.b > b.b;
  return a.a > b.a;
}

// Composites the layers at one depth: repeatedly finds the next colour in sorted order and applies it as many times as
// it occurs.
void lay_ties(uint first, uint depth, uint left) {
  uvec4 last = uvec4(0xffffffffu);  // the bits of no number; sorts before every colour
  while (left > 0u) {
    uvec4 next = uvec4(0u);
    uint count = 0u;
    for (uint n = first; n != 0u; n = nodes[n - 1u].place.y) {
      if (nodes[n - 1u].place.x != depth) continue;
      const uvec4 bits = floatBitsToUint(nodes[n - 1u].color);
      if (!is_before(last, bits)) continue;
      if (count > 0u && bits == next) {
        ++count;
      } else if (count == 0u || is_before(bits, next)) {
        next = bits;
        count = 1u;
      }
    }
    if (count == 0u) return;
    left -= count;
    for (; count > 0u; --count) lay(uintBitsToFloat(next));
    last = next;
  }
}

void main() {
  const uint first = lists.first[list_here()];
  if (first == 0u) discard;
  // Depth is reversed and positive, so its bits increase towards the eye.
  uint last = 0xffffffffu;
  for (bool behind = true; behind && through > 0.0;) {
    uint nearest = 0u, depth = 0u, count = 0u;
    behind = false;  // whether a layer lies behind the nearest one
    for (uint n = first; n != 0u;) {
      const uvec2 place = nodes[n - 1u].place.xy;
      if (place.x < last && place.x > depth) {
        behind = behind || count > 0u;
        nearest = n;
        depth = place.x;
        count = 1u;
      } else if (place.x == depth) {
        ++count;
      } else if (place.x < depth) {
        behind = true;
      }
      n = place.y;
    }
    if (count == 1u) {
      lay(nodes[nearest - 1u].color);
    } else {
      lay_ties(first, depth, count);
    }
    last = depth;
  }
  out_color = vec4(seen, through);
}
