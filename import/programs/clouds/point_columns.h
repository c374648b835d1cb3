// The points of a file as columns of numbers in memory, and the scene that they make.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "import/sandbox/imported_scene.h"

namespace simvis {

/// How a number is stored.
struct NumberType {
  enum class Kind : std::uint8_t { whole, natural, real };  ///< signed, unsigned, floating point
  Kind kind = Kind::real;
  unsigned bytes = 4;  ///< 1, 2, 4 or 8; of a real number 4 or 8
  bool big_endian = false;
};

/// Whether such numbers have more digits than float32.
inline bool has_more_digits(const NumberType& type) {
  return type.bytes == 8 || (type.kind != NumberType::Kind::real && type.bytes == 4);
}

/// The value of a full colour channel.
inline float color_range(const NumberType& type) {
  return type.kind == NumberType::Kind::real ? 1.0f : type.bytes == 1 ? 255.0f : 65535.0f;
}

/// A number of each point: that of point i lies at first + i * stride, all within the file's bytes.
struct PointColumn {
  const std::uint8_t* first = nullptr;
  std::size_t stride = 0;
  NumberType type{};

  double at(std::size_t point) const;
  /// The bits of a number of at most 32.
  std::uint32_t bits_at(std::size_t point) const;
};

/// What a file says of its points.
struct PointColumns {
  std::filesystem::path file;
  std::size_t count = 0;
  std::array<PointColumn, 3> place{};
  bool has_more_digits = false;      ///< coordinates have more digits than float32
  glm::dvec3 scale{1}, offset{0};    ///< a coordinate is offset + scale * number, in metres
  std::vector<PointColumn> color{};  ///< red, green, blue, sRGB from 0 to `color_range`; empty: none
  double color_range = 255;
  std::optional<PointColumn> packed_color{};  ///< 0xRRGGBB, sRGB
  std::optional<PointColumn> intensity{};     ///< read where there is no colour
  std::vector<PointColumn> normal{};          ///< along x, y, z; empty: none. Points with normals are lit
};

/// The columns x, y and z, and those of the normal if all three are there. find(name) returns a pointer to what the
/// header says of a column, with its `type`, or null; x, y and z are there. column(*find(name)) is its PointColumn.
template <class Find, class Column>
PointColumns named_columns(std::filesystem::path file, std::size_t count, const Find& find, const Column& column,
                           const std::array<std::string_view, 3>& normal_names) {
  PointColumns columns{.file = std::move(file), .count = count};
  constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const auto* const place = find(kAxes[axis]);
    columns.place[axis] = column(*place);
    columns.has_more_digits = columns.has_more_digits || has_more_digits(place->type);
  }
  for (const std::string_view name : normal_names) {
    if (const auto* const normal = find(name)) columns.normal.push_back(column(*normal));
  }
  if (columns.normal.size() != normal_names.size()) columns.normal.clear();
  return columns;
}

/// Sets the range of colours that may have more bits than the file uses: many programs write 8 of 16, some real numbers
/// up to 255, or nothing, which is no colour.
void fit_color_range(PointColumns& columns);

/// The largest number of points of a file, times import_factor().
inline constexpr std::size_t kMaxCloudPoints = 20'000'000;

/// A scene of one mesh of points. Where coordinates have more digits than float32, the mesh stands at the first point.
/// The intensity over the largest one is the colour of points that have none. Points that are not finite are left out,
/// with a warning. Throws InputError for files without points, and with more than kMaxCloudPoints.
ImportedScene cloud_scene(const PointColumns& columns);

/// As cloud_scene() throws: for counts that readers know before they read the points.
void check_point_count(const std::filesystem::path& file, std::size_t count);

}  // namespace simvis
