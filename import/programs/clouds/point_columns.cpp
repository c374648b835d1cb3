#include "import/programs/clouds/point_columns.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <simvis/location.h>
#include "engine/base/srgb.h"
#include "import/sandbox/import_limits.h"

namespace simvis {
namespace {

template <class T>
T read_as(const std::uint8_t* bytes, bool big_endian) {
  std::array<std::uint8_t, sizeof(T)> ordered;
  std::memcpy(ordered.data(), bytes, sizeof(T));
  if (big_endian) std::ranges::reverse(ordered);
  return std::bit_cast<T>(ordered);
}

// sRGB of whole numbers from 0 to `range` as linear values.
class LinearTable {
 public:
  explicit LinearTable(double range) : range_(range) {
    constexpr double kMaxTable = 65535;
    if (range != std::floor(range) || range > kMaxTable || range <= 1) return;
    for (double value = 0; value <= range; ++value) values_.push_back(linear_from_srgb(value / range));
  }
  float of(double value) const {
    if (!(value >= 0)) return 0;
    if (values_.empty()) return linear_from_srgb(std::min(value / range_, 1.0));
    return values_[std::min(static_cast<std::size_t>(value), values_.size() - 1)];
  }

 private:
  double range_;
  std::vector<float> values_;
};

// The linear colour of each point.
class PointColors {
 public:
  explicit PointColors(const PointColumns& columns) : columns_(columns), table_(columns.color_range) {
    if (!has_color() && columns.intensity) {
      for (std::size_t i = 0; i < columns.count; ++i) {
        const double value = columns.intensity->at(i);
        if (std::isfinite(value)) largest_ = std::max(largest_, value);
      }
    }
  }

  glm::vec4 of(std::size_t point) const {
    if (!columns_.color.empty()) {
      return {table_.of(columns_.color[0].at(point)), table_.of(columns_.color[1].at(point)),
              table_.of(columns_.color[2].at(point)), 1};
    }
    if (columns_.packed_color) {
      const std::uint32_t bits = columns_.packed_color->bits_at(point);
      return {table_.of(bits >> 16 & 255), table_.of(bits >> 8 & 255), table_.of(bits & 255), 1};
    }
    if (!columns_.intensity || largest_ == 0) return glm::vec4(1);
    const double share = columns_.intensity->at(point) / largest_;
    const auto grey = static_cast<float>(share > 0 ? std::min(share, 1.0) : 0);
    return {grey, grey, grey, 1};
  }

 private:
  bool has_color() const { return !columns_.color.empty() || columns_.packed_color; }

  const PointColumns& columns_;
  LinearTable table_;
  double largest_ = 0;
};

// Zero where there is none, or none that has a direction.
glm::vec3 normal_of(const PointColumns& columns, std::size_t point) {
  if (columns.normal.empty()) return glm::vec3(0);
  const glm::dvec3 normal(columns.normal[0].at(point), columns.normal[1].at(point), columns.normal[2].at(point));
  const double length = glm::length(normal);
  return length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0);
}

bool is_finite(const glm::dvec3& p) {
  // Beyond that, float32 does not hold the coordinate.
  constexpr double kFar_m = 1e30;
  return std::abs(p.x) < kFar_m && std::abs(p.y) < kFar_m && std::abs(p.z) < kFar_m;
}

}  // namespace

double PointColumn::at(std::size_t point) const {
  const std::uint8_t* const bytes = first + point * stride;
  const bool big = type.big_endian;
  if (type.kind == NumberType::Kind::real) {
    return type.bytes == 8 ? read_as<double>(bytes, big) : static_cast<double>(read_as<float>(bytes, big));
  }
  const bool is_signed = type.kind == NumberType::Kind::whole;
  switch (type.bytes) {
    case 1:
      return is_signed ? static_cast<double>(read_as<std::int8_t>(bytes, big)) : static_cast<double>(*bytes);
    case 2:
      return is_signed ? static_cast<double>(read_as<std::int16_t>(bytes, big))
                       : static_cast<double>(read_as<std::uint16_t>(bytes, big));
    case 4:
      return is_signed ? static_cast<double>(read_as<std::int32_t>(bytes, big))
                       : static_cast<double>(read_as<std::uint32_t>(bytes, big));
    default:
      return is_signed ? static_cast<double>(read_as<std::int64_t>(bytes, big))
                       : static_cast<double>(read_as<std::uint64_t>(bytes, big));
  }
}

std::uint32_t PointColumn::bits_at(std::size_t point) const {
  if (type.bytes == 4) return read_as<std::uint32_t>(first + point * stride, type.big_endian);
  constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
  const double value = at(point);
  return value > 0 ? static_cast<std::uint32_t>(std::min(value, kMost)) : 0;
}

void fit_color_range(PointColumns& columns) {
  double largest = 0;
  for (std::size_t i = 0; i < columns.count; ++i) {
    for (const PointColumn& color : columns.color) {
      if (std::isfinite(color.at(i))) largest = std::max(largest, color.at(i));
    }
  }
  const bool is_real = !columns.color.empty() && columns.color[0].type.kind == NumberType::Kind::real;
  columns.color_range = is_real && largest <= 1 ? 1 : largest <= 255 ? 255 : 65535;
  if (largest == 0) columns.color.clear();
}

void check_point_count(const std::filesystem::path& file, std::size_t count) {
  if (count == 0) fail_at({.file = file.string()}, "holds nothing to draw");
  const double most = import_factor() * static_cast<double>(kMaxCloudPoints);
  if (static_cast<double>(count) > most) {
    fail_at({.file = file.string()}, "has " + std::to_string(count) + " points, expected at most " +
                                         std::to_string(static_cast<std::uint64_t>(most)) + kRaiseLimits);
  }
}

ImportedScene cloud_scene(const PointColumns& columns) {
  check_point_count(columns.file, columns.count);
  ImportedScene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.name = columns.file.stem().string();
  mesh.topology = Topology::points;
  mesh.positions.reserve(columns.count);
  mesh.attributes.reserve(columns.count);
  const PointColors colors(columns);
  std::optional<glm::dvec3> origin;
  if (!columns.has_more_digits) origin.emplace(0);
  for (std::size_t i = 0; i < columns.count; ++i) {
    glm::dvec3 p;
    for (std::size_t axis = 0; axis < 3; ++axis) p[static_cast<int>(axis)] = columns.place[axis].at(i);
    p = columns.offset + columns.scale * p;
    if (!is_finite(p)) continue;
    if (!origin) origin = p;
    mesh.positions.emplace_back(p - *origin);
    mesh.attributes.push_back({.normal = normal_of(columns, i), .color = colors.of(i)});
  }
  check_point_count(columns.file, mesh.positions.size());
  if (const std::size_t left_out = columns.count - mesh.positions.size(); left_out > 0) {
    scene.warnings.push_back(columns.file.string() + ": " + std::to_string(left_out) +
                             " points are left out, whose places are not finite");
  }
  for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) mesh.indices.push_back(i);
  ImportedMaterial& material = scene.materials.emplace_back();
  material.is_fallback = true;
  material.material.unlit = columns.normal.empty();
  ImportedNode node;
  node.name = mesh.name;
  node.shapes = {{0, 0}};
  node.parent_from_node[3] = glm::dvec4(*origin, 1);
  scene.nodes.push_back(std::move(node));
  return scene;
}

}  // namespace simvis
