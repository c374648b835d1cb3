#include "exchange/messages/detections.h"

#include <algorithm>
#include <string_view>

#include "engine/base/assert.h"

namespace simvis::ros {
namespace {

constexpr std::string_view kObjectColumn = "object", kBoxColumn = "visible_x_min";

const MeasuredArray* find_column(std::span<const MeasuredArray> arrays, std::string_view name) {
  const auto found = std::ranges::find_if(
      arrays, [&](const MeasuredArray& each) { return each.kind == OutputKind::table_column && each.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

/// A row of the table.
struct BoxRow {
  std::span<const MeasuredArray> arrays;
  std::size_t row;

  double number(std::string_view column) const {
    const MeasuredArray* const found = find_column(arrays, column);
    SIMVIS_ASSERT(found != nullptr);
    return found->number(row);
  }
  std::uint32_t id(std::string_view column) const { return static_cast<std::uint32_t>(number(column)); }
};

BoundingBox2D box_in_image(const BoxRow& row) {
  const double left = row.number("visible_x_min"), right = row.number("visible_x_max"),
               top = row.number("visible_y_min"), bottom = row.number("visible_y_max");
  return {{{(left + right) / 2 - 0.5, (top + bottom) / 2 - 0.5}, 0}, right - left, bottom - top};
}

BoundingBox3D box_in_space(const BoxRow& row) {
  return {{{row.number("box_x_m"), row.number("box_y_m"), row.number("box_z_m")},
           {row.number("box_qx"), row.number("box_qy"), row.number("box_qz"), row.number("box_qw")}},
          {row.number("box_size_x_m"), row.number("box_size_y_m"), row.number("box_size_z_m")}};
}

std::string class_of(const BoxRow& row, const ClassNames& names) {
  const std::uint32_t id = row.id("object_class");
  const auto found = names.find(id);
  return found == names.end() || found->second.empty() ? std::to_string(id) : found->second;
}

}  // namespace

bool has_boxes(std::span<const MeasuredArray> arrays) {
  return find_column(arrays, kObjectColumn) != nullptr && find_column(arrays, kBoxColumn) != nullptr;
}

Detections detections(std::span<const MeasuredArray> arrays, std::optional<std::uint32_t> view,
                      const ClassNames& class_names, const Header& header) {
  Detections all{{header, {}}, {header, {}}};
  const std::size_t rows = find_column(arrays, kObjectColumn)->shape.rows;
  for (std::size_t i = 0; i < rows; ++i) {
    const BoxRow row{arrays, i};
    if (row.number("visible_pixels") == 0 || (view && row.id("view") != *view)) continue;
    const BoundingBox3D box = box_in_space(row);
    const ObjectHypothesisWithPose result{{class_of(row, class_names), 1}, {box.center, {}}};
    const std::string id = std::to_string(row.id(kObjectColumn));
    all.in_image.detections.push_back({header, {result}, box_in_image(row), id});
    all.in_space.detections.push_back({header, {result}, box, id});
  }
  return all;
}

}  // namespace simvis::ros
