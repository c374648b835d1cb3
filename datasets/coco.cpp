#include "datasets/coco.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "datasets/classes.h"
#include "datasets/pixel_mask.h"
#include "datasets/seen_view.h"
#include "scenegraph/pictures/png_file.h"
#include "simvis/output/output_writer.h"

namespace simvis {
namespace {

constexpr std::string_view kCoco = "coco";

Record annotation_of(const SeenView& view, const SeenThing& thing) {
  const BoxPx& box = thing.visible;
  return {{"category_id", thing.semantic},
          {"bbox", {box.x_min, box.y_min, box.x_max - box.x_min, box.y_max - box.y_min}},
          {"area", thing.visible_pixels},
          {"iscrowd", 0},
          {"segmentation",
           {{"size", {view.camera.height_px, view.camera.width_px}},
            {"counts", coco_rle(mask_of(*view.instance, thing.instance))}}},
          {"instance_id", thing.instance},
          {"visible_fraction", thing.visible_fraction},
          {"truncated", thing.truncated}};
}

}  // namespace

void CocoFormat::begin(std::span<const DatasetSensor> sensors) {
  for (const DatasetSensor& sensor : sensors) {
    if (!is_camera(sensor)) refuse_sensor(sensor, kCoco, "cameras only");
    require_outputs(sensor, kCoco, {kNeedsColor, kNeedsInstance, kNeedsBoxes});
  }
  require_own_names(sensors, kCoco);
}

FramePiece CocoFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  Record images = Record::array();
  for (const SeenView& view : views_of(frame.sensors)) {
    const std::string file = view.name + "/" + frame_name(frame.time.index) + ".png";
    piece.files.push_back({"images/" + file, [color = *view.color] { return encode_png(color); },
                           view.color->pixels.size() * sizeof(float)});
    Record annotations = Record::array();
    for (const SeenThing& thing : view.things) {
      if (thing.visible_pixels > 0) annotations.push_back(annotation_of(view, thing));
    }
    images.push_back({{"camera", view.name},
                      {"image",
                       {{"file_name", file},
                        {"width", view.camera.width_px},
                        {"height", view.camera.height_px},
                        {"frame", frame.time.index},
                        {"time_s", static_cast<double>(frame.time.time_ns) / 1e9}}},
                      {"annotations", std::move(annotations)}});
  }
  piece.record = {{"images", std::move(images)}, {"classes", classes_record(frame.items)}};
  return piece;
}

std::vector<DatasetFile> CocoFormat::whole(std::span<const Record> records) const {
  std::map<std::string, std::vector<const Record*>> cameras;
  for (const Record& record : records) {
    for (const Record& image : record.at("images")) cameras[image.at("camera").get<std::string>()].push_back(&image);
  }
  Record images = Record::array(), annotations = Record::array(), categories = Record::array();
  for (const auto& [camera, pictures] : cameras) {
    for (const Record* const picture : pictures) {
      Record image{{"id", images.size() + 1}};
      image.update(picture->at("image"));
      for (const Record& each : picture->at("annotations")) {
        Record annotation{{"id", annotations.size() + 1}, {"image_id", images.size() + 1}};
        annotation.update(each);
        annotations.push_back(std::move(annotation));
      }
      images.push_back(std::move(image));
    }
  }
  for (const auto& [id, name] : all_classes(records)) {
    categories.push_back({{"id", id}, {"name", name}, {"supercategory", ""}});
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

}  // namespace simvis
