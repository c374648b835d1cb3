#include "import/mjcf/mjcf_solid.h"

#include <vector>

#include <simvis/location.h>

namespace simvis {
namespace {

// The sizes of a geom; the length of one with `fromto` takes the place of its half length.
std::vector<double> sizes_of(const MjcfElement& geom, std::size_t count, const std::vector<double>& ends) {
  std::vector<double> sizes = geom.numbers("size", 1, 3);
  if (!ends.empty()) {
    const glm::dvec3 way(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]);
    const double half = glm::length(way) / 2;
    // Of a box and an ellipsoid, the one size is that of both axes across.
    const double across = sizes.empty() ? 0 : sizes[0];
    sizes = count == 2 ? std::vector{across, half} : std::vector{across, across, half};
  }
  if (sizes.size() < count && !geom.unknown_class().empty()) {
    geom.fail("has no sizes, and the class " + in_quotes(geom.unknown_class()) + ", which no <default> defines");
  }
  if (sizes.size() < count)
    geom.fail("has " + std::to_string(sizes.size()) + " sizes, expected " + std::to_string(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (!(sizes[i] > 0)) geom.fail("has a size that is not above 0");
  }
  return sizes;
}

}  // namespace

void read_mjcf_solid(const MjcfElement& geom, const std::string& type, ModelShape& shape) {
  using Kind = ModelShape::Kind;
  const std::vector<double> ends = geom.numbers("fromto", 6, 6);
  if (type == "sphere") {
    shape.kind = Kind::sphere;
    shape.size.x = sizes_of(geom, 1, {})[0];
  } else if (type == "capsule" || type == "cylinder") {
    const std::vector<double> sizes = sizes_of(geom, 2, ends);
    shape.kind = type == "capsule" ? Kind::capsule : Kind::cylinder;
    shape.size = {sizes[0], 0, 2 * sizes[1]};
  } else if (type == "box" || type == "ellipsoid") {
    const std::vector<double> sizes = sizes_of(geom, 3, ends);
    shape.kind = type == "box" ? Kind::box : Kind::ellipsoid;
    shape.size = (type == "box" ? 2.0 : 1.0) * glm::dvec3(sizes[0], sizes[1], sizes[2]);
  } else {
    geom.fail("is of type " + in_quotes(type) +
              ", which is not taken over, expected plane, sphere, capsule, ellipsoid, cylinder, box, mesh or hfield");
  }
}

}  // namespace simvis
