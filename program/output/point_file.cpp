#include "program/output/point_file.h"
#include "program/output/number_text.h"

#include <array>
#include <limits>

#include "engine/base/assert.h"
#include "program/output/formats.h"
#include "program/output/pose_text.h"

namespace simvis {

namespace {

/// The fields of a point: x, y, z, then the other columns.
struct PointField {
  std::string name;
  NumberType type;
  std::size_t column;
};

/// Readers of point clouds know no whole numbers of 64 bits: a column has int32, or float64 where that does not hold
/// its numbers.
NumberType point_number_type(const TableFrame& table, std::size_t column) {
  const NumberType type = number_type(table.columns[column]);
  if (type != NumberType::int64) return type;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double value = table.at(row, column);
    if (value > std::numeric_limits<std::int32_t>::max() || value < std::numeric_limits<std::int32_t>::min()) {
      return NumberType::float64;
    }
  }
  return NumberType::int32;
}

std::vector<PointField> fields_of(const TableFrame& table, const PointColumns& points) {
  std::vector<PointField> fields = {
      {"x", NumberType::float32, points.x}, {"y", NumberType::float32, points.y}, {"z", NumberType::float32, points.z}};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c == points.x || c == points.y || c == points.z) continue;
    fields.push_back({table.columns[c].name, point_number_type(table, c), c});
  }
  return fields;
}

void append_points(std::string& bytes, const TableFrame& table, const std::vector<std::size_t>& rows,
                   const std::vector<PointField>& fields) {
  for (const std::size_t row : rows) {
    for (const PointField& field : fields) append_as(bytes, field.type, table.at(row, field.column));
  }
}

PointColumns required_points(const TableFrame& table) {
  const std::optional<PointColumns> points = point_columns(table);
  SIMVIS_ASSERT(points.has_value());
  return *points;
}

const char* ply_type(NumberType type) {
  return type == NumberType::int32 ? "int" : type == NumberType::float32 ? "float" : "double";
}

}  // namespace

std::string encode_ply(const TableFrame& table) {
  const PointColumns points = required_points(table);
  const std::vector<std::size_t> rows = rows_with_points(table, points);
  const std::vector<PointField> fields = fields_of(table, points);
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment time_s x_m y_m z_m qx qy qz qw of the sensor\ncomment " +
      tum_line(table.time, table.world_from_sensor) + "element vertex " + std::to_string(rows.size()) + "\n";
  for (const PointField& field : fields) {
    bytes += std::string("property ") + ply_type(field.type) + " " + field.name + "\n";
  }
  bytes += "end_header\n";
  append_points(bytes, table, rows, fields);
  return bytes;
}

std::string encode_pcd(const TableFrame& table) {
  const PointColumns points = required_points(table);
  const std::vector<std::size_t> rows = rows_with_points(table, points);
  const std::vector<PointField> fields = fields_of(table, points);
  std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (const PointField& field : fields) {
    names += " " + field.name;
    sizes += " " + std::to_string(size_of(field.type));
    types += field.type == NumberType::int32 ? " I" : " F";
    counts += " 1";
  }
  const Pose3 pose = pose_of(table.world_from_sensor);
  std::string viewpoint = "VIEWPOINT";
  for (const double value : {pose.position_m.x, pose.position_m.y, pose.position_m.z, pose.orientation.w,
                             pose.orientation.x, pose.orientation.y, pose.orientation.z}) {
    viewpoint += ' ';
    append_exact(viewpoint, value);
  }
  const std::string count = std::to_string(rows.size());
  std::string bytes = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + names + "\n" + sizes + "\n" +
                      types + "\n" + counts + "\nWIDTH " + count + "\nHEIGHT 1\n" + viewpoint + "\nPOINTS " + count +
                      "\nDATA binary\n";
  append_points(bytes, table, rows, fields);
  return bytes;
}

std::string encode_kitti(const TableFrame& table) {
  const PointColumns points = required_points(table);
  const std::optional<std::size_t> intensity = table.find("intensity");
  std::string bytes;
  for (const std::size_t row : rows_with_points(table, points)) {
    for (const std::size_t column : {points.x, points.y, points.z}) {
      append_as(bytes, NumberType::float32, table.at(row, column));
    }
    append_as(bytes, NumberType::float32, intensity ? table.at(row, *intensity) : 0);
  }
  return bytes;
}

namespace {

bool has_points(const TableFrame& table) { return point_columns(table).has_value(); }

const FormatRegistration kPlyFormat(
    {.kind = "scan",
     .name = "ply",
     .file = "SCANNER/000000.ply",
     .text =
         "the beams that hit something, as binary points x y z in the sensor's frame with the other columns, angles as "
         "doubles; the comments hold the pose of the sensor",
     .order = 30,
     .encode_table = encode_ply,
     .fits = has_points}),
    kPcdFormat({.kind = "scan",
                .name = "pcd",
                .file = "SCANNER/000000.pcd",
                .text = "the same; `VIEWPOINT` holds the pose of the sensor",
                .order = 40,
                .encode_table = encode_pcd,
                .fits = has_points}),
    kKittiFormat(
        {.kind = "scan",
         .name = "bin",
         .file = "SCANNER/000000.bin",
         .text = "KITTI's layout: four float32 for each point, x y z and `intensity` (0 without such a column)",
         .order = 50,
         .encode_table = encode_kitti,
         .fits = has_points});

}  // namespace

}  // namespace simvis
