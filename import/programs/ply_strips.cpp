#include "import/programs/ply_strips.h"

namespace simvis {

void PlyStrips::add(std::int64_t vertex) {
  if (vertex < 0) return end_strip();
  const auto corner = static_cast<std::uint32_t>(vertex);
  const auto [a, b] = last_;
  last_ = {b, corner};
  if (++corners_ < 3 || a == b || b == corner || a == corner) return;
  triangles_.push_back(corners_ % 2 == 1 ? Triangle{a, b, corner} : Triangle{b, a, corner});
}

std::string PlyStrips::header() const {
  return "element face " + std::to_string(triangles_.size()) + "\nproperty list uchar int vertex_indices\n";
}

std::string PlyStrips::body(PlyEncoding encoding) const {
  std::string faces;
  for (const Triangle& triangle : triangles_) {
    faces += encoding == PlyEncoding::text ? "3" : "\x03";
    for (const std::uint32_t corner : triangle) {
      if (encoding == PlyEncoding::text) faces += " " + std::to_string(corner);
      for (unsigned i = 0; encoding != PlyEncoding::text && i < 4; ++i) {
        faces += static_cast<char>(corner >> (8 * (encoding == PlyEncoding::little_endian ? i : 3 - i)));
      }
    }
    if (encoding == PlyEncoding::text) faces += "\n";
  }
  return faces;
}

}  // namespace simvis
