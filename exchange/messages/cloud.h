// Clouds of points: what PointCloud2 of all sensors have in common. x, y and z are float32 at the bytes 0, 4 and 8, the
// only form in which readers of clouds, such as those of PCL, take them.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/types/sensor_types.h"

namespace simvis::ros {

/// Values of PointField::datatype.
inline constexpr std::uint8_t kUint8 = 2, kUint16 = 4, kUint32 = 6, kFloat32 = 7, kFloat64 = 8;

/// A field behind x, y and z.
struct CloudField {
  std::string_view name;
  std::uint8_t datatype;
  std::uint32_t offset;  ///< in bytes
};

/// Writes a value of a point.
template <typename T>
void put(std::uint8_t* point, std::uint32_t offset, T value) {
  std::memcpy(point + offset, &value, sizeof value);
}

/// A cloud without points, with x, y, z and these fields.
inline PointCloud2 empty_cloud(const Header& header, std::span<const CloudField> fields, std::uint32_t point_step) {
  PointCloud2 cloud;
  cloud.header = header;
  cloud.height = 1;
  cloud.is_dense = true;
  cloud.point_step = point_step;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    cloud.fields.push_back({std::string(1, "xyz"[axis]), axis * std::uint32_t{sizeof(float)}, kFloat32, 1});
  }
  for (const CloudField& each : fields) cloud.fields.push_back({std::string(each.name), each.offset, each.datatype, 1});
  return cloud;
}

/// Fills an empty cloud with points in rows, or in one row with those alone that are not NaN if `dense`. `write(i,
/// point)` writes the fields of point i behind z, whose bytes are 0 before.
template <typename Write>
void fill_cloud(PointCloud2& cloud, std::span<const glm::dvec3> points, std::uint32_t rows, bool dense,
                const Write& write) {
  cloud.data.resize(points.size() * cloud.point_step);
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool is_point = !std::isnan(points[i].x);
    if (dense && !is_point) continue;
    cloud.is_dense = cloud.is_dense && is_point;
    std::uint8_t* const point = cloud.data.data() + count++ * cloud.point_step;
    for (int axis = 0; axis < 3; ++axis) {
      put(point, static_cast<std::uint32_t>(axis) * std::uint32_t{sizeof(float)}, static_cast<float>(points[i][axis]));
    }
    write(i, point);
  }
  cloud.data.resize(count * cloud.point_step);
  cloud.height = dense ? 1 : rows;
  cloud.width = static_cast<std::uint32_t>(count) / (cloud.height == 0 ? 1 : cloud.height);
  cloud.row_step = cloud.point_step * cloud.width;
}

}  // namespace simvis::ros
