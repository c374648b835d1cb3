#include "sensors/camera/object_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <simvis/pose.h>
#include "engine/draw/oriented_box.h"
#include "sensors/camera/camera_outputs.h"

namespace simvis {
namespace {

constexpr double kNoBox = std::numeric_limits<double>::quiet_NaN();

/// The columns, in their order. A camera of one view has no column `view`.
const std::vector<TableColumn>& object_columns() {
  static const std::vector<TableColumn> columns = [] {
    std::vector<TableColumn> all;
    const auto whole = [&](const char* name, const char* meaning) {
      all.push_back({.name = name, .format = "%lld", .integer = true, .meaning = meaning});
    };
    const auto number = [&](std::string name, const char* unit, const char* meaning, const char* frame = "") {
      all.push_back({.name = std::move(name),
                     .format = std::string(kExactFormat),
                     .unit = unit,
                     .meaning = meaning,
                     .frame = frame});
    };
    const auto optional = [&](std::string name, const char* unit, const char* meaning) {
      number(std::move(name), unit, meaning);
      all.back().nothing = kNoBox;
    };
    const auto box = [&](const std::string& name, const char* meaning) {
      for (const char* const side : {"_x_min", "_y_min", "_x_max", "_y_max"}) optional(name + side, "px", meaning);
    };
    whole("view", "0: left, 1: right");
    whole("object", "id of the thing, as in instances.csv");
    whole("object_class", "id of its class");
    whole("visible_pixels", "pixels that show the thing");
    whole("picture_pixels", "pixels of the picture that would show it if it stood alone");
    whole("full_pixels", "the same with one more picture on each side");
    number("visible_fraction", "", "share of picture_pixels that shows it");
    number("truncated", "", "share of full_pixels outside the picture");
    box("visible", "box of visible_pixels");
    box("picture", "box of picture_pixels");
    box("full", "box of full_pixels");
    optional("nearest_m", "m", "range of the nearest visible pixel");
    number("distance_m", "m", "from the camera to the middle of the box in space");
    for (const char* const axis : {"box_x_m", "box_y_m", "box_z_m"})
      number(axis, "m", "middle of the box in space", "optical");
    for (const char* const axis : {"box_size_x_m", "box_size_y_m", "box_size_z_m"})
      number(axis, "m", "its lengths, along its own axes");
    for (const char* const part : {"box_qw", "box_qx", "box_qy", "box_qz"})
      number(part, "", "its orientation as a quaternion", "optical");
    return all;
  }();
  return columns;
}

void add_rect(const PixelSet& set, std::vector<double>& row) {
  if (set.pixels == 0) {
    row.insert(row.end(), 4, kNoBox);
    return;
  }
  for (const int side : {set.rect.x_begin, set.rect.y_begin, set.rect.x_end, set.rect.y_end}) row.push_back(side);
}

/// What the pixels of a picture show of one item.
struct VisibleItem {
  PixelSet pixels{};
  double nearest_m = std::numeric_limits<double>::infinity();
};

bool has_row(const SeenPicture& picture, std::uint32_t item) {
  const DrawList& list = picture.world.list;
  const Mesh& mesh = *list.meshes[list.items[item].mesh];
  const bool is_endless =
      mesh.surface && mesh.surface->kind == SurfaceKind::plane && std::isinf(mesh.surface->half_size_m.x);
  return list.items[item].visible && picture.world.ids.semantic[item] != 0 && !is_endless;
}

/// The items that may have a row, by their ids.
std::map<std::uint32_t, std::uint32_t> classified(const SeenPicture& picture) {
  std::map<std::uint32_t, std::uint32_t> items;
  for (std::uint32_t item = 0; item < picture.world.list.items.size(); ++item) {
    if (has_row(picture, item)) items[picture.world.ids.instance[item]] = item;
  }
  return items;
}

/// What the picture shows of each item, by item. Items without a row are left empty.
std::vector<VisibleItem> visible_items(const SeenPicture& picture, const std::map<std::uint32_t, std::uint32_t>& rows) {
  std::vector<VisibleItem> items(picture.world.list.items.size());
  std::vector<std::uint8_t> wanted(items.size());
  for (const auto& [id, item] : rows) wanted[item] = 1;
  const std::vector<std::uint32_t>& shown = picture.pixels.item;
  const std::size_t width_px = picture.pixels.width_px;
  for (std::size_t pixel = 0; pixel < shown.size();) {
    const std::size_t first = pixel, row_end = (pixel / width_px + 1) * width_px;
    const std::uint32_t item = shown[first];
    while (pixel < row_end && shown[pixel] == item) ++pixel;
    if (item == kNoItem || wanted[item] == 0) continue;
    VisibleItem& own = items[item];
    own.pixels.add_run(static_cast<int>(first % width_px), static_cast<int>(pixel - first + first % width_px),
                       static_cast<int>(first / width_px));
    const auto ranges = std::span(picture.pixels.range_m).subspan(first, pixel - first);
    own.nearest_m = std::min(own.nearest_m, static_cast<double>(*std::ranges::min_element(ranges)));
  }
  return items;
}

double share(std::uint64_t part, std::uint64_t whole) { return static_cast<double>(part) / static_cast<double>(whole); }

void add_row(const SeenPicture& picture, std::uint32_t item, const Silhouette& s, double nearest_m,
             std::vector<double>& values) {
  const DrawList& list = picture.world.list;
  values.push_back(picture.world.ids.instance[item]);
  values.push_back(picture.world.ids.semantic[item]);
  for (const PixelSet& set : {s.visible, s.picture, s.full}) values.push_back(static_cast<double>(set.pixels));
  values.push_back(share(s.visible.pixels, s.picture.pixels));
  values.push_back(1 - share(s.picture.pixels, s.full.pixels));
  for (const PixelSet& set : {s.visible, s.picture, s.full}) add_rect(set, values);
  const OrientedBox box =
      oriented_box(*list.meshes[list.items[item].mesh],
                   rigid_inverse(picture.world_from_camera) * list.world_from_node[list.items[item].transform]);
  values.push_back(s.visible.pixels == 0 ? kNoBox : nearest_m);
  values.push_back(glm::length(box.centre_m));
  for (int axis = 0; axis < 3; ++axis) values.push_back(box.centre_m[axis]);
  for (int axis = 0; axis < 3; ++axis) values.push_back(box.size_m[axis]);
  values.insert(values.end(), {box.orientation.w, box.orientation.x, box.orientation.y, box.orientation.z});
}

}  // namespace

std::vector<OutputSpec> object_outputs(const AttributeValues& attributes, bool views) {
  const std::span<const TableColumn> columns = object_columns();
  std::vector<OutputSpec> outputs = column_outputs(columns.subspan(views ? 0 : 1), OutputKind::table_column,
                                                   {.rows = 0, .columns = 1, .channels = 1});
  for (OutputSpec& each : outputs) {
    each.when = "boxes among outputs";
    each.given = attributes.flag("outputs", "boxes");
  }
  return outputs;
}

OutputSpec silhouettes_output(const std::string& prefix, const AttributeValues& attributes) {
  return {.name = prefix + kSilhouettes,
          .kind = OutputKind::image,
          .value_type = ValueType::u8,
          .shape = image_shape(attributes, 0),
          .meaning = "1: the pixel would show the thing of this row of the table if it stood alone",
          .when = "silhouettes among outputs",
          .given = attributes.flag("outputs", "silhouettes")};
}

RayCast silhouette_cast(const std::string& what, const std::string& sensor, std::uint64_t pixels) {
  constexpr std::uint64_t kPictures = 9;  // of the canvas
  return {.name = sensor,
          .reason = "pixels of " + what + " that may show a hidden part of a thing with a class, for each thing",
          .max_rays = kPictures * pixels};
}

void ObjectTable::begin() {
  measured_ = true;
  values_.overwrite().clear();
}

void ObjectTable::add(const SeenPicture& picture, std::size_t view, ItemSilhouettes& silhouettes) {
  silhouettes.begin(picture.world.list);
  const std::uint32_t width_px = picture.pixels.width_px;
  const std::map<std::uint32_t, std::uint32_t> rows = classified(picture);
  const std::vector<VisibleItem> visible = visible_items(picture, rows);
  std::vector<double>& values = values_.edit();
  std::vector<std::vector<std::uint8_t>> masks;
  for (const auto& [id, item] : rows) {
    std::vector<std::uint8_t> mask;
    if (desc_.silhouettes) {
      for (const std::uint32_t shown : picture.pixels.item) mask.push_back(shown == item ? 1 : 0);
    }
    const Silhouette silhouette =
        silhouettes.find(picture.world.list, item, {picture.pixels.item, picture.pixels.range_m, picture.rows},
                         visible[item].pixels, mask);
    if (silhouette.picture.pixels == 0) continue;
    if (pictures_.size() > 1) values.push_back(static_cast<double>(view));
    add_row(picture, item, silhouette, visible[item].nearest_m, values);
    if (desc_.silhouettes) masks.push_back(std::move(mask));
  }
  if (!desc_.silhouettes) return;
  Picture& own = pictures_[view];
  own.width_px = width_px;
  if (masks.empty()) masks.emplace_back(picture.pixels.item.size(), std::uint8_t{0});  // an image has a channel
  own.things = static_cast<std::uint32_t>(masks.size());
  const std::size_t pixels = picture.pixels.item.size();
  own.height_px = static_cast<std::uint32_t>(pixels / width_px);
  std::vector<std::uint8_t>& all = own.masks.overwrite();
  all.resize(pixels * masks.size());
  for (std::size_t thing = 0; thing < masks.size(); ++thing) {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) all[pixel * masks.size() + thing] = masks[thing][pixel];
  }
}

void ObjectTable::add_to(Measurement& measurement, std::span<const char* const> names) const {
  if (!desc_.boxes) return;
  const std::span<const TableColumn> all = object_columns();
  const std::span<const TableColumn> columns = all.subspan(pictures_.size() > 1 ? 0 : 1);
  const auto rows = static_cast<std::uint32_t>(values_.size() / columns.size());
  const std::vector<OutputSpec> outputs = column_outputs(columns, OutputKind::table_column, {rows, 1, 1});
  for (std::size_t i = 0; i < columns.size(); ++i) {
    measurement.arrays.push_back({outputs[i], values_, i, columns.size()});
  }
  if (!desc_.silhouettes) return;
  for (std::size_t view = 0; view < pictures_.size(); ++view) {
    const Picture& picture = pictures_[view];
    measurement.arrays.push_back({{.name = std::string(names[view]) + (names[view][0] == 0 ? "" : "_") + kSilhouettes,
                                   .kind = OutputKind::image,
                                   .value_type = ValueType::u8,
                                   .shape = {picture.height_px, picture.width_px, picture.things},
                                   .view = names[view]},
                                  picture.masks});
  }
}

}  // namespace simvis
