#include "import/mjcf/mjcf_cube.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace simvis {
namespace {

// How the picture lies on the side at +axis or -axis (OpenGL 4.6, table 8.19): along which axes it goes to the right
// and down.
struct CubeSide {
  int across, down;
  double across_sign, down_sign;
};
constexpr std::array<std::array<CubeSide, 2>, 3> kCubeSides = {
    {{{{2, 1, -1, -1}, {2, 1, 1, -1}}}, {{{0, 2, 1, 1}, {0, 2, 1, -1}}}, {{{0, 1, 1, -1}, {0, 1, -1, -1}}}}};

constexpr double kMinAway = 1e-30;  // so that nothing is divided by 0

glm::dvec2 on_strip(const glm::dvec2& uv, int axis, bool is_negative) {
  constexpr double kInset = 1e-3;  // so that rounding takes no texel of the side above or below
  const double square = 2 * axis + (is_negative ? 1 : 0);
  return {std::clamp(uv.x, kInset, 1 - kInset), (square + std::clamp(uv.y, kInset, 1 - kInset)) / 6};
}

}  // namespace

Mesh cube_textured(const Mesh& mesh, const glm::dmat4& cube_from_mesh, CubeSides sides) {
  if (mesh.topology != Topology::triangles) return mesh;
  Mesh made;
  made.name = mesh.name;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::array<glm::dvec3, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] = glm::dvec3(cube_from_mesh * glm::dvec4(mesh.positions[mesh.indices[i + c]], 1));
    }
    const glm::dvec3 middle = corners[0] + corners[1] + corners[2], size = glm::abs(middle);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const double sign = middle[axis] < 0 ? -1 : 1;
    const CubeSide& side = kCubeSides[static_cast<std::size_t>(axis)][sign < 0 ? 1 : 0];
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec3& at = corners[c];
      // A corner of another side is at the edge of this one.
      const double away = std::max(sign * at[axis], kMinAway);
      VertexAttributes attributes = mesh.attributes[mesh.indices[i + c]];
      glm::dvec2 uv = glm::clamp(
          0.5 + 0.5 * glm::dvec2(side.across_sign * at[side.across], side.down_sign * at[side.down]) / away, 0.0, 1.0);
      if (sides == CubeSides::own) uv = on_strip(uv, axis, sign < 0);
      attributes.uv[0] = attributes.uv[1] = glm::vec2(uv);
      made.indices.push_back(static_cast<std::uint32_t>(made.positions.size()));
      made.positions.push_back(mesh.positions[mesh.indices[i + c]]);
      made.attributes.push_back(attributes);
    }
  }
  compute_bounds(made);
  return made;
}

}  // namespace simvis
