// COCO: pictures, and one file of boxes and masks for detection.
//
//   images/CAMERA/000000.png
//   depth/CAMERA/000000.png      of cameras with depth: 16 bits; the image has `depth_unit_m`, the length of one code
//   annotations/instances.json
//
// Boxes    [x, y, width, height] of the visible pixels, the width being the number of columns, as COCO's own tools
//          make them from a mask; `area` is the number of visible pixels. What shows no pixel has no annotation.
// Masks    run lengths as a text, see coco_rle(). `iscrowd` is 0.
// Ids      `category_id` is the id of the class. Pictures and annotations count from 1, by camera and frame.
// Points   of sensors `keypoints`, see seen_points.h: x and y in pixels from the centre of the first pixel; v is 0 for
//          a point that is not in the picture, 1 for a hidden one, 2 for a visible one. A category has the names of the
//          keypoints of all its annotations, sorted.
// More     `instance_id`, `visible_fraction` and `truncated` are additions that readers of COCO pass over.
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "program/datasets/classes.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/pixel_mask.h"
#include "program/datasets/seen_points.h"
#include "program/datasets/seen_view.h"
#include "program/output/depth_png_file.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

class CocoFormat : public DatasetFormat {
 public:
  explicit CocoFormat(double depth_unit_m) : depth_unit_m_(depth_unit_m) {}
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  double depth_unit_m_;
};

constexpr std::string_view kCoco = "coco";

// The key of an annotation's keypoints in records.
constexpr const char* kPoints = "points";

// COCO's visibility flag `v` of a keypoint.
enum : int { kNotLabelled = 0, kHidden = 1, kVisible = 2 };

/// [x, y, v] of each keypoint, by its name.
Record points_record(const SeenPoints& points) {
  Record record = Record::object();
  for (const auto& [name, point] : points) {
    record[name] = Record{0, 0, kNotLabelled};
    if (!point.in_picture) continue;
    record[name] = {point.x_px - kFirstCentre_px, point.y_px - kFirstCentre_px, point.visible ? kVisible : kHidden};
  }
  return record;
}

/// The names of the keypoints of each class.
std::map<std::uint32_t, std::set<std::string>> point_names(std::span<const Record> records) {
  std::map<std::uint32_t, std::set<std::string>> names;
  for (const Record& record : records) {
    for (const Record& image : record.at("images")) {
      for (const Record& annotation : image.at("annotations")) {
        if (!annotation.contains(kPoints)) continue;
        for (const auto& [name, point] : annotation.at(kPoints).items()) {
          names[annotation.at("category_id").get<std::uint32_t>()].insert(name);
        }
      }
    }
  }
  return names;
}

/// Writes the keypoints of an annotation as COCO has them: a list of x, y and v for all names of its class, in the
/// order of `names`. An annotation without keypoints gets them with v 0.
void order_points(const std::set<std::string>& names, Record& annotation) {
  const Record own = annotation.value(kPoints, Record::object());
  annotation.erase(kPoints);
  if (names.empty()) return;
  Record points = Record::array();
  int labelled = 0;
  for (const std::string& name : names) {
    const Record point = own.value(name, Record{0, 0, kNotLabelled});
    for (std::size_t i = 0; i < 3; ++i) points.push_back(point.at(i));
    labelled += point.at(2).get<int>() != kNotLabelled ? 1 : 0;
  }
  annotation["keypoints"] = std::move(points);
  annotation["num_keypoints"] = labelled;
}

Record annotation_of(const SeenView& view, const ObjectInView& object) {
  const BoxPx& box = object.visible;
  return {{"category_id", object.semantic},
          {"bbox", {box.x_min, box.y_min, box.x_max - box.x_min, box.y_max - box.y_min}},
          {"area", object.visible_pixels},
          {"iscrowd", 0},
          {"segmentation",
           {{"size", {view.camera.height_px, view.camera.width_px}},
            {"counts", coco_rle(mask_of(*view.instance, object.instance))}}},
          {"instance_id", object.instance},
          {"visible_fraction", object.visible_fraction},
          {"truncated", object.truncated}};
}

}  // namespace

void CocoFormat::begin(std::span<const DatasetSensor> sensors) {
  for (const DatasetSensor& sensor : sensors) {
    if (is_keypoints(sensor)) continue;
    if (!is_camera(sensor)) refuse_sensor(sensor, kCoco, "cameras and their keypoints");
    require_outputs(sensor, kCoco, {kNeedsColor, kNeedsInstance, kNeedsBoxes});
  }
  require_views(sensors, kCoco);
  require_own_names(sensors, kCoco);
}

FramePiece CocoFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  Record images = Record::array();
  const std::vector<SeenView> views = views_of(frame.sensors);
  const FramePoints points(frame, views, kCoco);
  for (const SeenView& view : views) {
    const std::string file = view.name + "/" + frame_name(frame.time.index) + ".png";
    piece.files.push_back({"images/" + file, [color = *view.color] { return encode_png(color); },
                           view.color->pixels.size() * sizeof(float)});
    Record annotations = Record::array();
    for (const ObjectInView& object : view.objects) {
      if (object.visible_pixels == 0) continue;
      annotations.push_back(annotation_of(view, object));
      const SeenPoints own = points.of(view, object.instance);
      if (!own.empty()) annotations.back()[kPoints] = points_record(own);
    }
    images.push_back({{"camera", view.name},
                      {"image",
                       {{"file_name", file},
                        {"width", view.camera.width_px},
                        {"height", view.camera.height_px},
                        {"frame", frame.time.index},
                        {"time_s", static_cast<double>(frame.time.time_ns) / 1e9}}},
                      {"annotations", std::move(annotations)}});
    if (!view.depth) continue;
    images.back()["image"]["depth_unit_m"] = depth_unit_m_;
    piece.files.push_back({"depth/" + file,
                           [depth = *view.depth, unit_m = depth_unit_m_] { return encode_depth_png(depth, unit_m); },
                           view.depth->pixels.size() * sizeof(float)});
  }
  piece.record = {{"images", std::move(images)}, {"classes", classes_record(frame.items)}};
  return piece;
}

std::vector<DatasetFile> CocoFormat::whole(std::span<const Record> records) const {
  std::map<std::string, std::vector<const Record*>> cameras;
  for (const Record& record : records) {
    for (const Record& image : record.at("images")) cameras[image.at("camera").get<std::string>()].push_back(&image);
  }
  std::map<std::uint32_t, std::set<std::string>> points = point_names(records);
  Record images = Record::array(), annotations = Record::array(), categories = Record::array();
  for (const auto& [camera, pictures] : cameras) {
    for (const Record* const picture : pictures) {
      Record image{{"id", images.size() + 1}};
      image.update(picture->at("image"));
      for (const Record& each : picture->at("annotations")) {
        Record annotation{{"id", annotations.size() + 1}, {"image_id", images.size() + 1}};
        annotation.update(each);
        order_points(points[each.at("category_id").get<std::uint32_t>()], annotation);
        annotations.push_back(std::move(annotation));
      }
      images.push_back(std::move(image));
    }
  }
  for (const auto& [id, name] : all_classes(records)) {
    categories.push_back({{"id", id}, {"name", name}, {"supercategory", ""}});
    if (points[id].empty()) continue;
    categories.back()["keypoints"] = points[id];
    categories.back()["skeleton"] = Record::array();
  }
  const Record all{{"info", {{"description", "made with SimVis"}}},
                   {"licenses", Record::array()},
                   {"images", std::move(images)},
                   {"annotations", std::move(annotations)},
                   {"categories", std::move(categories)}};
  std::vector<DatasetFile> files;
  files.push_back(text_file("annotations/instances.json", all.dump() + "\n"));
  return files;
}

namespace {

const DatasetFormatRegistration kCocoRegistration(kCoco, [](double depth_unit_m) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<CocoFormat>(depth_unit_m);
});

}  // namespace
}  // namespace simvis
