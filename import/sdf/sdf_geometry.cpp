#include "import/sdf/sdf_geometry.h"

#include <algorithm>
#include <string>

#include <simvis/pose.h>
#include "import/mesh/height_picture.h"
#include "import/model/turn_z_to.h"

namespace simvis {
namespace {

template <class Vector>
Vector sizes_above_zero(const SdfElement& shape, const char* tag, const Vector& fallback) {
  const Vector sizes = shape.child(tag).vector(fallback);
  for (int i = 0; i < Vector::length(); ++i) {
    if (!(sizes[i] > 0 && sizes[i] <= kMaxCoordinate_m)) {
      shape.fail("has a <" + std::string(tag) + "> that is not above 0");
    }
  }
  return sizes;
}

}  // namespace

double sdf_size(const SdfElement& shape, const char* tag, double fallback) {
  const double size = shape.child(tag).number(fallback);
  if (!(size > 0 && size <= kMaxCoordinate_m)) shape.fail("has a <" + std::string(tag) + "> that is not above 0");
  return size;
}

glm::dvec2 sdf_sizes(const SdfElement& shape, const char* tag, const glm::dvec2& fallback) {
  return sizes_above_zero(shape, tag, fallback);
}

glm::dvec3 sdf_sizes(const SdfElement& shape, const char* tag, const glm::dvec3& fallback) {
  return sizes_above_zero(shape, tag, fallback);
}

glm::dmat4 sdf_plane_turn(const SdfElement& plane) {
  const glm::dvec3 normal = plane.child("normal").vector(glm::dvec3(0, 0, 1));
  if (normal == glm::dvec3(0)) plane.fail("has a <normal> without length");
  return glm::dmat4(turn_z_to(normal));
}

HeightMap sdf_height_map(const SdfElement& map, SdfFiles& files) {
  const SdfElement uri = map.child("uri");
  if (!uri || uri.text().empty()) map.fail("has no <uri>");
  std::string why;
  const auto file = files.find(uri.text(), uri, why);
  if (!file) uri.fail("names a picture that cannot be read: " + why);
  const glm::dvec3 size_m = sdf_height_map_size(map);
  const HeightPicture picture = read_height_picture(*file);
  const float highest = *std::ranges::max_element(picture.values);
  // Gazebo gives the highest pixel the height of <size>.
  return height_map(picture, glm::dvec2(size_m), 0, highest > 0 ? size_m.z / highest : size_m.z);
}

}  // namespace simvis
