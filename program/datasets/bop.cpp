// BOP, the benchmark for 6-D poses of objects: docs/bop_datasets_format.md of bop_toolkit.
//
//   camera.json                      the first camera
//   models/obj_000001.ply            millimetres, in the frame of the object's box; models/models_info.json
//   train/000000/                    one scene for each view of a camera, by their names
//     rgb/000000.png depth/000000.png mask/000000_000000.png mask_visib/000000_000000.png
//     scene_camera.json scene_gt.json scene_gt_info.json
//
// Objects  Items that have a class; items of the same mesh and scale are the same object. Objects are numbered from
//          1 by their lowest instance id. All frames must have the same objects.
// Poses    from the object's box to the camera (x right, y down, z forward), in millimetres; matrices row by row.
// Depth    along the optical axis: 16-bit codes x depth_scale are millimetres; 0: nothing, or too far for the codes.
// Boxes    (x, y, xmax - xmin, ymax - ymin) of pixel numbers, so that one pixel has the width 0. `bbox_obj` and
//          `px_count_all` are of the silhouette with a picture's width and height more on each side; `bbox_visib` is
//          all -1 where nothing is visible. Visibility is exact, whereas the toolkit's own is a test of distances with
//          a tolerance of 15 mm in which missing depth counts as visible.
#include <algorithm>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "program/datasets/classes.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/object_model.h"
#include "program/datasets/pixel_mask.h"
#include "program/datasets/seen_view.h"
#include "program/output/depth_png_file.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

class BopFormat : public DatasetFormat {
 public:
  /// `depth_unit_m` is the length of one code of depth.
  explicit BopFormat(double depth_unit_m) : depth_unit_m_(depth_unit_m) {}
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  double depth_unit_m_;
  std::vector<std::string> scenes_;  // names of views, by the number of the scene
};

constexpr std::string_view kBop = "bop";

Record rows_of(const glm::dmat3& m) {
  Record rows = Record::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rows.push_back(m[column][row]);
  }
  return rows;
}

Record millimetres(const glm::dvec3& at_m) {
  return {kMillimetres * at_m.x, kMillimetres * at_m.y, kMillimetres * at_m.z};
}

// Numbers of pixels start at 0 in their centres.
Record camera_matrix(const Pinhole& p) {
  return {p.fx_px, 0.0, p.cx_px - 0.5, 0.0, p.fy_px, p.cy_px - 0.5, 0.0, 0.0, 1.0};
}

Record bop_box(const BoxPx& box) {
  Record numbers = Record::array();
  for (const double number : {box.x_min, box.y_min, box.x_max - box.x_min - 1, box.y_max - box.y_min - 1}) {
    numbers.push_back(static_cast<std::int64_t>(number));
  }
  return numbers;
}

/// The pixels of a mask that have a code of depth.
std::uint64_t with_depth(const PixelMask& mask, const Image& depth, double unit_m) {
  std::uint64_t pixels = 0;
  for (std::size_t i = 0; i < mask.pixels.size(); ++i) {
    pixels += mask.pixels[i] != 0 && depth_code(depth.pixels[i], unit_m) != 0 ? 1 : 0;
  }
  return pixels;
}

std::string hex(std::uint64_t number) {
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << number;
  return text.str();
}

/// Objects of the same model.
struct BopObject {
  std::uint64_t hash = 0;
  const SceneObject* first = nullptr;
  glm::dvec3 scale{1};
};

/// The objects of a scene, in the order of their numbers, and these numbers by instance.
struct BopObjects {
  std::vector<BopObject> objects{};
  std::map<std::uint32_t, std::uint32_t> number{};

  explicit BopObjects(const DatasetFrame& frame) {
    std::map<std::uint32_t, const SceneObject*> all;  // by instance
    for (const SceneObject& each : frame.objects) {
      if (each.semantic != 0 && has_model(frame.list, each)) all[each.instance] = &each;
    }
    for (const auto& [instance, object] : all) {
      const glm::dvec3 scale = scale_of(frame.list, *object, "--dataset bop: object \"" + object->path + "\"");
      const std::uint64_t hash = model_hash(frame.list, *object, scale);
      const auto known = std::ranges::find(objects, hash, &BopObject::hash);
      number[instance] = static_cast<std::uint32_t>(known - objects.begin()) + 1;
      if (known == objects.end()) objects.push_back({hash, object, scale});
    }
  }
};

std::string model_file(std::size_t number) { return "models/obj_" + frame_name(number) + ".ply"; }

Record model_info(const ObjectModel& model) {
  const glm::dvec3 size = model.high_mm - model.low_mm;
  return {{"diameter", diameter_mm(model)},
          {"min_x", model.low_mm.x},
          {"min_y", model.low_mm.y},
          {"min_z", model.low_mm.z},
          {"size_x", size.x},
          {"size_y", size.y},
          {"size_z", size.z}};
}

/// The models of all objects and their table.
void add_models(const BopObjects& objects, const DatasetFrame& frame, FramePiece& piece) {
  Record info = Record::object();
  for (std::size_t i = 0; i < objects.objects.size(); ++i) {
    const BopObject& object = objects.objects[i];
    ObjectModel model = object_model(frame.list, *object.first, object.scale);
    info[std::to_string(i + 1)] = model_info(model);
    const std::size_t bytes = model.positions_mm.size() * 2 * sizeof(glm::vec3);
    piece.files.push_back({model_file(i + 1), [model = std::move(model)] { return model_ply(model); }, bytes});
  }
  piece.files.push_back(text_file("models/models_info.json", info.dump(2) + "\n"));
}

Record objects_record(const BopObjects& objects) {
  Record record = Record::array();
  for (const BopObject& object : objects.objects) {
    record.push_back({{"hash", hex(object.hash)}, {"object", object.first->path}, {"class", object.first->semantic}});
  }
  return record;
}

/// The files and the record of one view.
class BopView {
 public:
  BopView(const SeenView& view, std::string scene, const BopObjects& objects, std::uint64_t frame, double depth_unit_m)
      : view_(view),
        folder_("train/" + std::move(scene) + "/"),
        objects_(objects),
        depth_unit_m_(depth_unit_m),
        number_(frame_name(frame)) {}

  void add_to(FramePiece& piece) {
    const auto image = [&](const std::string& path, auto encode) {
      piece.files.push_back({folder_ + path, std::move(encode), 4 * view_.color->pixels.size()});
    };
    image("rgb/" + number_ + ".png", [color = *view_.color] { return encode_png(color); });
    image("depth/" + number_ + ".png",
          [depth = *view_.depth, unit_m = depth_unit_m_] { return encode_depth_png(depth, unit_m); });
    Record gt = Record::array(), info = Record::array();
    for (std::uint32_t i = 0; i < view_.objects.size(); ++i) add_object(i, piece, gt, info);
    const glm::dmat4 optical_from_world = glm::inverse(view_.world_from_optical);
    piece.record["views"].push_back({{"view", view_.name},
                                     {"size", {view_.camera.width_px, view_.camera.height_px}},
                                     {"camera",
                                      {{"cam_K", camera_matrix(view_.camera.pinhole)},
                                       {"depth_scale", kMillimetres * depth_unit_m_},
                                       {"cam_R_w2c", rows_of(glm::dmat3(optical_from_world))},
                                       {"cam_t_w2c", millimetres(optical_from_world[3])}}},
                                     {"gt", std::move(gt)},
                                     {"gt_info", std::move(info)}});
  }

 private:
  void add_object(std::uint32_t number, FramePiece& piece, Record& gt, Record& info) const {
    const ObjectInView& object = view_.objects[number];
    const PixelMask silhouette = mask_channel(*view_.silhouettes, number),
                    visible = mask_of(*view_.instance, object.instance);
    const std::string file = number_ + "_" + frame_name(number) + ".png";
    for (const auto& [name, mask] : {std::pair("mask/", &silhouette), {"mask_visib/", &visible}}) {
      piece.files.push_back(
          {folder_ + name + file, [pixels = *mask] { return mask_png(pixels); }, mask->pixels.size()});
    }
    gt.push_back({{"cam_R_m2c", rows_of(object.optical_from_box)},
                  {"cam_t_m2c", millimetres(object.centre_m)},
                  {"obj_id", objects_.number.at(object.instance)},
                  {"instance_id", object.instance}});
    info.push_back(
        {{"bbox_obj", bop_box(object.full)},
         {"bbox_visib", object.visible_pixels == 0 ? Record{-1, -1, -1, -1} : bop_box(object.visible)},
         {"px_count_all", object.full_pixels},
         {"px_count_valid", with_depth(silhouette, *view_.depth, depth_unit_m_)},
         {"px_count_visib", object.visible_pixels},
         {"visib_fract", static_cast<double>(object.visible_pixels) / static_cast<double>(object.full_pixels)}});
  }

  const SeenView& view_;
  std::string folder_;
  const BopObjects& objects_;
  double depth_unit_m_;
  std::string number_;
};

/// The tables of a scene, by the numbers of its pictures.
struct BopScene {
  Record camera = Record::object(), gt = Record::object(), gt_info = Record::object();
};

}  // namespace

void BopFormat::begin(std::span<const DatasetSensor> sensors) {
  for (const DatasetSensor& sensor : sensors) {
    if (!is_camera(sensor)) refuse_sensor(sensor, kBop, "cameras only");
    require_outputs(sensor, kBop, {kNeedsColor, kNeedsDepth, kNeedsInstance, kNeedsBoxes, kNeedsSilhouettes});
    require_pinhole(sensor, kBop);
  }
  require_views(sensors, kBop);
  require_own_names(sensors, kBop);
  scenes_.clear();
  for (const SeenView& view : views_of(sensors)) scenes_.push_back(view.name);
}

FramePiece BopFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  const BopObjects objects(frame);
  piece.record["views"] = Record::array();
  for (const SeenView& view : views_of(frame.sensors)) {
    const auto scene = std::ranges::find(scenes_, view.name) - scenes_.begin();
    BopView(view, frame_name(static_cast<std::uint64_t>(scene)), objects, frame.time.index, depth_unit_m_)
        .add_to(piece);
  }
  piece.record["frame"] = frame.time.index;
  piece.record["objects"] = objects_record(objects);
  piece.record["classes"] = classes_record(frame.items);
  if (frame.time.index == 0) add_models(objects, frame, piece);
  return piece;
}

std::vector<DatasetFile> BopFormat::whole(std::span<const Record> records) const {
  std::map<std::string, BopScene> scenes;
  std::vector<DatasetFile> files;
  for (const Record& record : records) {
    const auto number = std::to_string(record.at("frame").get<std::uint64_t>());
    if (record.at("objects") != records.front().at("objects")) {
      throw InputError("--dataset bop: frame " + number +
                       " has other objects with a class than frame 0, expected the same objects, meshes and scales in "
                       "all frames, and links of one object that do not move against each other");
    }
    for (const Record& view : record.at("views")) {
      BopScene& scene = scenes[view.at("view").get<std::string>()];
      scene.camera[number] = view.at("camera");
      scene.gt[number] = view.at("gt");
      scene.gt_info[number] = view.at("gt_info");
    }
  }
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const BopScene& scene = scenes[scenes_[i]];
    const std::string folder = "train/" + frame_name(i) + "/";
    files.push_back(text_file(folder + "scene_camera.json", scene.camera.dump() + "\n"));
    files.push_back(text_file(folder + "scene_gt.json", scene.gt.dump() + "\n"));
    files.push_back(text_file(folder + "scene_gt_info.json", scene.gt_info.dump() + "\n"));
  }
  const Record& first = records.front().at("views").at(0);
  const Record& k = first.at("camera").at("cam_K");
  const Record camera{{"cx", k.at(2)},
                      {"cy", k.at(5)},
                      {"depth_scale", first.at("camera").at("depth_scale")},
                      {"fx", k.at(0)},
                      {"fy", k.at(4)},
                      {"height", first.at("size").at(1)},
                      {"width", first.at("size").at(0)}};
  files.push_back(text_file("camera.json", camera.dump(2) + "\n"));
  files.push_back(text_file("objects.json", records.front().at("objects").dump(2) + "\n"));
  return files;
}

namespace {

const DatasetFormatRegistration kBopRegistration(kBop, [](double depth_unit_m) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<BopFormat>(depth_unit_m);
});

}  // namespace
}  // namespace simvis
