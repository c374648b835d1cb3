#include "sensors/camera/object_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
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
    whole("object", "id of the object, as in objects.csv");
    whole("object_class", "id of its class");
    whole("visible_pixels", "pixels that show the object");
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

/// What the pixels of a picture show of one object.
struct VisibleObject {
  PixelSet pixels{};
  double nearest_m = std::numeric_limits<double>::infinity();
};

/// An object that may have a row.
struct LabelledObject {
  const SceneObject* object = nullptr;
  std::vector<std::uint32_t> items{};  ///< those that are not hidden
};

/// By their ids.
std::vector<LabelledObject> labelled(const SeenPicture& picture) {
  std::vector<LabelledObject> objects;
  for (const SceneObject& object : picture.world.objects) {
    if (object.semantic == 0 || !std::isfinite(object.low_m.x)) continue;
    std::vector<std::uint32_t> items;
    for (const ObjectSurface& each : object.surfaces) {
      if (picture.world.list.items[each.item].visible) items.push_back(each.item);
    }
    if (!items.empty()) objects.push_back({&object, std::move(items)});
  }
  std::ranges::sort(objects, {}, [](const LabelledObject& each) { return each.object->instance; });
  return objects;
}

/// By pixel: the place of the object that it shows; kNoItem: none of them.
std::vector<std::uint32_t> shown_objects(const SeenPicture& picture, std::span<const LabelledObject> objects) {
  std::vector<std::uint32_t> object_of(picture.world.list.items.size(), kNoItem);
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    for (const std::uint32_t item : objects[i].items) object_of[item] = i;
  }
  std::vector<std::uint32_t> shown;
  shown.reserve(picture.pixels.item.size());
  for (const std::uint32_t item : picture.pixels.item) shown.push_back(item == kNoItem ? kNoItem : object_of[item]);
  return shown;
}

/// What the picture shows of each object.
std::vector<VisibleObject> visible_objects(const SeenPicture& picture, std::span<const std::uint32_t> shown,
                                           std::size_t count) {
  std::vector<VisibleObject> objects(count);
  const std::size_t width_px = picture.pixels.width_px;
  for (std::size_t pixel = 0; pixel < shown.size();) {
    const std::size_t first = pixel, row_end = (pixel / width_px + 1) * width_px;
    const std::uint32_t object = shown[first];
    while (pixel < row_end && shown[pixel] == object) ++pixel;
    if (object == kNoItem) continue;
    VisibleObject& own = objects[object];
    own.pixels.add_run(static_cast<int>(first % width_px), static_cast<int>(pixel - first + first % width_px),
                       static_cast<int>(first / width_px));
    const auto ranges = std::span(picture.pixels.range_m).subspan(first, pixel - first);
    own.nearest_m = std::min(own.nearest_m, static_cast<double>(*std::ranges::min_element(ranges)));
  }
  return objects;
}

double share(std::uint64_t part, std::uint64_t whole) { return static_cast<double>(part) / static_cast<double>(whole); }

void add_row(const SeenPicture& picture, const SceneObject& object, const Silhouette& s, double nearest_m,
             std::vector<double>& values) {
  values.push_back(object.instance);
  values.push_back(object.semantic);
  for (const PixelSet& set : {s.visible, s.picture, s.full}) values.push_back(static_cast<double>(set.pixels));
  values.push_back(share(s.visible.pixels, s.picture.pixels));
  values.push_back(1 - share(s.picture.pixels, s.full.pixels));
  for (const PixelSet& set : {s.visible, s.picture, s.full}) add_rect(set, values);
  const OrientedBox box =
      oriented_box(object.low_m, object.high_m,
                   rigid_inverse(picture.world_from_camera) * picture.world.list.world_from_node[object.transform]);
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
          .meaning = "1: the pixel would show the object of this row of the table if it stood alone",
          .when = "silhouettes among outputs",
          .given = attributes.flag("outputs", "silhouettes")};
}

RayCast silhouette_cast(const std::string& what, const std::string& sensor, std::uint64_t pixels) {
  constexpr std::uint64_t kPictures = 9;  // of the canvas
  return {.name = sensor,
          .reason = "pixels of " + what + " that may show a hidden part of an object with a class, for each object",
          .max_rays = kPictures * pixels};
}

void ObjectTable::begin() {
  measured_ = true;
  values_.overwrite().clear();
}

void ObjectTable::add(const SeenPicture& picture, std::size_t view, ObjectSilhouettes& silhouettes) {
  silhouettes.begin(picture.world.list, picture.threads);
  const std::uint32_t width_px = picture.pixels.width_px;
  const std::vector<LabelledObject> objects = labelled(picture);
  const std::vector<std::uint32_t> shown = shown_objects(picture, objects);
  const std::vector<VisibleObject> visible = visible_objects(picture, shown, objects.size());
  std::vector<double>& values = values_.edit();
  std::vector<std::vector<std::uint8_t>> masks;
  for (std::uint32_t object = 0; object < objects.size(); ++object) {
    std::vector<std::uint8_t> mask;
    if (desc_.silhouettes) {
      for (const std::uint32_t each : shown) mask.push_back(each == object ? 1 : 0);
    }
    const Silhouette silhouette =
        silhouettes.find(picture.world.list, object, objects[object].items,
                         {shown, picture.pixels.range_m, picture.rows}, visible[object].pixels, mask);
    if (silhouette.picture.pixels == 0) continue;
    if (pictures_.size() > 1) values.push_back(static_cast<double>(view));
    add_row(picture, *objects[object].object, silhouette, visible[object].nearest_m, values);
    if (desc_.silhouettes) masks.push_back(std::move(mask));
  }
  if (!desc_.silhouettes) return;
  Picture& own = pictures_[view];
  own.width_px = width_px;
  if (masks.empty()) masks.emplace_back(picture.pixels.item.size(), std::uint8_t{0});  // an image has a channel
  own.objects = static_cast<std::uint32_t>(masks.size());
  const std::size_t pixels = picture.pixels.item.size();
  own.height_px = static_cast<std::uint32_t>(pixels / width_px);
  std::vector<std::uint8_t>& all = own.masks.overwrite();
  all.resize(pixels * masks.size());
  for (std::size_t object = 0; object < masks.size(); ++object) {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) all[pixel * masks.size() + object] = masks[object][pixel];
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
                                   .shape = {picture.height_px, picture.width_px, picture.objects},
                                   .view = names[view]},
                                  picture.masks});
  }
}

}  // namespace simvis
