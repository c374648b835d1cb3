#include "exchange/messages/detections.h"

#include <algorithm>
#include <array>
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

const MeasuredArray& column(std::span<const MeasuredArray> arrays, std::string_view name) {
  const MeasuredArray* const found = find_column(arrays, name);
  SIMVIS_ASSERT(found != nullptr);
  return *found;
}

/// The columns of the table that messages have.
struct BoxColumns {
  explicit BoxColumns(std::span<const MeasuredArray> arrays)
      : object(column(arrays, kObjectColumn)),
        object_class(column(arrays, "object_class")),
        view(find_column(arrays, "view")),
        pixels(column(arrays, "visible_pixels")),
        left(column(arrays, kBoxColumn)),
        right(column(arrays, "visible_x_max")),
        top(column(arrays, "visible_y_min")),
        bottom(column(arrays, "visible_y_max")),
        center{&column(arrays, "box_x_m"), &column(arrays, "box_y_m"), &column(arrays, "box_z_m")},
        turn{&column(arrays, "box_qx"), &column(arrays, "box_qy"), &column(arrays, "box_qz"),
             &column(arrays, "box_qw")},
        size{&column(arrays, "box_size_x_m"), &column(arrays, "box_size_y_m"), &column(arrays, "box_size_z_m")} {}

  const MeasuredArray &object, &object_class;
  const MeasuredArray* view;  // null: there is one view
  const MeasuredArray &pixels, &left, &right, &top, &bottom;
  std::array<const MeasuredArray*, 3> center;
  std::array<const MeasuredArray*, 4> turn;  // x, y, z, w
  std::array<const MeasuredArray*, 3> size;
};

std::uint32_t id_in(const MeasuredArray& ids, std::size_t row) { return static_cast<std::uint32_t>(ids.number(row)); }

BoundingBox2D box_in_image(const BoxColumns& of, std::size_t row) {
  const double left = of.left.number(row), right = of.right.number(row), top = of.top.number(row),
               bottom = of.bottom.number(row);
  return {{{(left + right) / 2 - 0.5, (top + bottom) / 2 - 0.5}, 0}, right - left, bottom - top};
}

BoundingBox3D box_in_space(const BoxColumns& of, std::size_t row) {
  const auto number = [row](const MeasuredArray* column) { return column->number(row); };
  return {{{number(of.center[0]), number(of.center[1]), number(of.center[2])},
           {number(of.turn[0]), number(of.turn[1]), number(of.turn[2]), number(of.turn[3])}},
          {number(of.size[0]), number(of.size[1]), number(of.size[2])}};
}

std::string class_of(std::uint32_t id, const ClassNames& names) {
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
  const BoxColumns of(arrays);
  SIMVIS_ASSERT(!view || of.view != nullptr);
  for (std::size_t row = 0; row < of.object.shape.rows; ++row) {
    if (of.pixels.number(row) == 0 || (view && id_in(*of.view, row) != *view)) continue;
    const BoundingBox3D box = box_in_space(of, row);
    const ObjectHypothesisWithPose result{{class_of(id_in(of.object_class, row), class_names), 1}, {box.center, {}}};
    const std::string name = std::to_string(id_in(of.object, row));
    all.in_image.detections.push_back({header, {result}, box_in_image(of, row), name});
    all.in_space.detections.push_back({header, {result}, box, name});
  }
  return all;
}

}  // namespace simvis::ros
