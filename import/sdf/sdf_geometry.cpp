#include "import/sdf/sdf_geometry.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/pose.h>
#include "import/mesh/height_picture.h"
#include "import/model/turn_z_to.h"
#include "import/sdf/sdf_polyline.h"
#include "scenegraph/primitive_meshes.h"

namespace simvis {
namespace {

[[noreturn]] void refuse_size(const SdfElement& shape, const char* tag, double size) {
  shape.fail("has a <" + std::string(tag) + "> of " + format_number(size) + ", expected more than 0 and at most " +
             format_number(kMaxCoordinate_m) + " m");
}

template <class Vector>
Vector sizes_above_zero(const SdfElement& shape, const char* tag, const Vector& fallback) {
  const Vector sizes = shape.child(tag).vector(fallback);
  for (int i = 0; i < Vector::length(); ++i) {
    if (!(sizes[i] > 0 && sizes[i] <= kMaxCoordinate_m)) {
      refuse_size(shape, tag, sizes[i]);
    }
  }
  return sizes;
}

}  // namespace

double sdf_size(const SdfElement& shape, const char* tag, double fallback) {
  const double size = shape.child(tag).number(fallback);
  if (!(size > 0 && size <= kMaxCoordinate_m)) refuse_size(shape, tag, size);
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

bool read_sdf_solid(const SdfElement& shape, ModelShape& read) {
  using Kind = ModelShape::Kind;
  const std::string_view tag = shape.tag();
  const auto surface = [&](Mesh mesh) {
    read.kind = Kind::surface;
    read.surface = std::make_shared<const Mesh>(std::move(mesh));
  };
  if (tag == "box") {
    read.kind = Kind::box;
    read.size = sdf_sizes(shape, "size", glm::dvec3(1));
  } else if (tag == "sphere") {
    read.kind = Kind::sphere;
    read.size.x = sdf_size(shape, "radius", 1);
  } else if (tag == "cylinder") {
    read.kind = Kind::cylinder;
    read.size = {sdf_size(shape, "radius", 1), 0, sdf_size(shape, "length", 1)};
  } else if (tag == "capsule") {
    read.kind = Kind::capsule;
    read.size = {sdf_size(shape, "radius", 0.5), 0, sdf_size(shape, "length", 1)};
  } else if (tag == "ellipsoid") {
    read.kind = Kind::ellipsoid;
    read.size = sdf_sizes(shape, "radii", glm::dvec3(1));
  } else if (tag == "cone") {
    surface(cone_mesh(sdf_size(shape, "radius", 0.5), sdf_size(shape, "length", 1)));
  } else if (tag == "polyline") {
    surface(sdf_polyline_mesh(shape));
  } else {
    return false;
  }
  return true;
}

void read_sdf_height_map(const SdfElement& map, SdfFiles& files, ModelShape& read) {
  glm::dmat4 place(1);
  place[3] = glm::dvec4(map.child("pos").vector(glm::dvec3(0)), 1);
  read.link_from_shape = read.link_from_shape * place;
  read.kind = ModelShape::Kind::surface;
  read.surface = std::make_shared<const Mesh>(mesh_in_place(sdf_height_map(map, files)));
}

void read_sdf_mesh(const SdfElement& mesh, SdfFiles& files, ModelShape& read) {
  read.kind = ModelShape::Kind::mesh;
  read.size = mesh.child("scale").vector(glm::dvec3(1));
  for (int i = 0; i < 3; ++i) {
    if (read.size[i] == 0 || !(std::abs(read.size[i]) <= kMaxCoordinate_m)) {
      mesh.fail("has a <scale> of 0 or without a limit");
    }
  }
  const SdfElement uri = mesh.child("uri");
  if (!uri || uri.text().empty()) mesh.fail("has no <uri>");
  std::string why;
  const auto file = files.find(uri.text(), uri, why);
  if (!file) uri.fail("names a mesh file that cannot be read: " + why);
  read.file = *file;
}

HeightMap sdf_height_map(const SdfElement& map, SdfFiles& files) {
  const SdfElement uri = map.child("uri");
  if (!uri || uri.text().empty()) map.fail("has no <uri>");
  std::string why;
  const auto file = files.find(uri.text(), uri, why);
  if (!file) uri.fail("names a picture that cannot be read: " + why);
  const glm::dvec3 size_m = sdf_height_map_size(map);
  const HeightPicture picture = read_height_picture(*file);
  const double highest = *std::ranges::max_element(picture.values) * picture.unit;
  // Gazebo gives the highest pixel the height of <size>.
  return height_map(picture, glm::dvec2(size_m), 0, highest > 0 ? size_m.z / highest : size_m.z);
}

}  // namespace simvis
