// COLMAP: a sparse model as text, with the true poses.
//
//   images/CAMERA_000000.png         the views of the cameras with the number of the frame, all in one folder
//   sparse/0/cameras.txt             "ID MODEL width height fx fy cx cy ...", one for each view
//   sparse/0/images.txt              "ID qw qx qy qz tx ty tz CAMERA_ID NAME", then its points: "x y POINT_ID ..."
//   sparse/0/points3D.txt            "ID x y z r g b 0 IMAGE_ID INDEX"
//
// Poses    lead from the world to the optical frame (x right, y down, z forward).
// Lenses   PINHOLE, OPENCV (k1 k2 p1 p2), FULL_OPENCV (k1 k2 p1 p2 k3 k4 k5 k6) and OPENCV_FISHEYE (k1 k2 k3 k4) of
//          https://colmap.github.io/cameras.html.
// Pixels   count from the picture's corner, as everywhere in COLMAP.
// Points   the surfaces at the centres of pixels on an even grid, from the exact depth, each in the image that saw it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/depth_points.h>
#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/srgb.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/rigid_text.h"
#include "program/datasets/seen_view.h"
#include "program/output/exif.h"
#include "program/output/output_writer.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {
namespace {

/// A surface at the centre of a pixel.
struct ColmapPoint {
  double x_m, y_m, z_m;             ///< in the world
  double column_px, row_px;         ///< of the pixel, from the picture's corner
  std::array<std::uint8_t, 8> rgb;  ///< as sRGB codes; five zeros follow
};

/// What one view of a frame adds to the files of the whole.
struct ColmapView {
  std::string image_line;    ///< of images.txt
  std::string kept;          ///< the name of its points
  std::uint64_t kept_bytes;  ///< of these
};

class ColmapFormat : public DatasetFormat {
 public:
  void begin(std::span<const DatasetSensor> sensors) override;
  FramePiece frame(const DatasetFrame& frame) const override;
  std::vector<DatasetFile> whole(std::span<const Record> records) const override;

 private:
  std::string images(std::span<const ColmapView> views) const;  // images.txt
  std::string points(std::span<const ColmapView> views) const;  // points3D.txt

  std::vector<std::string> views_;  // names of the views; camera 1 first
  std::string cameras_;             // cameras.txt
};

constexpr std::string_view kColmap = "colmap", kColmapHolds = "cameras";
constexpr double kPointsPerView = 1000;  // about

std::string numbers_text(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : " ") + format_number(number);
  return text;
}

struct ColmapLens {
  std::string model;
  std::vector<double> coefficients;
};

/// COLMAP's name of the lens and its coefficients. Throws InputError for a lens that COLMAP does not have.
ColmapLens colmap_lens(const CameraCalibration& camera, const std::string& sensor) {
  std::vector<double> k = camera.distortion_coefficients;
  if (is_pinhole(camera)) return {"PINHOLE", {}};
  if (camera.distortion_model == "equidistant" && k.size() == 4) return {"OPENCV_FISHEYE", k};
  if (camera.distortion_model == "rational_polynomial" && k.size() == 8) return {"FULL_OPENCV", k};
  if (camera.distortion_model == "plumb_bob" && k.size() == 5) {
    const bool is_short = k[4] == 0;
    k.resize(is_short ? 4 : 8);
    return {is_short ? "OPENCV" : "FULL_OPENCV", k};
  }
  throw InputError("--dataset colmap: camera \"" + sensor +
                   "\" has a lens that the format cannot describe, expected distortion=\"none\", brown_conrady, "
                   "kannala_brandt, or rational_polynomial without thin prism and tilt");
}

std::string camera_line(const SeenView& view, std::size_t id) {
  const CameraCalibration& camera = view.camera;
  const Pinhole& p = camera.pinhole;
  const ColmapLens lens = colmap_lens(camera, view.name);
  std::vector<double> numbers{p.fx_px, p.fy_px, p.cx_px, p.cy_px};
  numbers.insert(numbers.end(), lens.coefficients.begin(), lens.coefficients.end());
  return std::to_string(id) + " " + lens.model + " " + std::to_string(camera.width_px) + " " +
         std::to_string(camera.height_px) + " " + numbers_text(numbers) + "\n";
}

/// Surfaces at the centres of pixels on an even grid, each a ColmapPoint.
std::string pack_points(const SeenView& view) {
  const Image &color = *view.color, &depth = *view.depth;
  const std::vector<glm::dvec3> seen = optical_points(depth, view.camera);
  const double pixels = static_cast<double>(depth.width) * depth.height;
  const auto step = static_cast<std::uint32_t>(std::ceil(std::sqrt(pixels / kPointsPerView)));
  std::string points;
  for (std::uint32_t row = step / 2; row < depth.height; row += step) {
    for (std::uint32_t column = step / 2; column < depth.width; column += step) {
      const std::size_t pixel = std::size_t{row} * depth.width + column;
      if (!(seen[pixel].z > 0)) continue;  // COLMAP sees nothing beside and behind a camera
      const glm::dvec4 point = view.world_from_optical * glm::dvec4(seen[pixel], 1);
      ColmapPoint packed{point.x, point.y, point.z, column + kFirstCentre_px, row + kFirstCentre_px, {}};
      srgb_codes(std::span<const float>(&color.pixels[4 * pixel], 4), std::span(packed.rgb).first(3));
      append_binary(points, packed);
    }
  }
  return points;
}

std::string points_name(std::size_t camera, std::uint64_t frame) {
  return std::to_string(camera) + "/" + frame_name(frame) + ".bin";
}

std::string image_line(const Record& view, std::size_t image) {
  const glm::dmat4 optical_from_world = glm::inverse(rigid_of(view.at("pose")));
  const glm::dvec4 q = quaternion_xyzw(optical_from_world), t = optical_from_world[3];
  return std::to_string(image) + " " + numbers_text({q.w, q.x, q.y, q.z, t.x, t.y, t.z}) + " " +
         std::to_string(view.at("camera").get<std::size_t>()) + " " + view.at("file").get<std::string>() + "\n";
}

}  // namespace

void ColmapFormat::begin(std::span<const DatasetSensor> sensors) {
  views_.clear();
  cameras_ = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n";
  for (const DatasetSensor& sensor : sensors) {
    if (!is_camera(sensor)) refuse_sensor(sensor, kColmap, kColmapHolds);
    require_outputs(sensor, kColmap, {kNeedsColor, kNeedsDepth});
  }
  require_views(sensors, kColmap);
  require_own_names(sensors, kColmap);
  for (const SeenView& view : views_of(sensors)) {
    views_.push_back(view.name);
    cameras_ += camera_line(view, views_.size());
  }
}

FramePiece ColmapFormat::frame(const DatasetFrame& frame) const {
  FramePiece piece;
  Record views = Record::array();
  for (const SeenView& view : views_of(frame.sensors)) {
    const std::string file = view.name + "_" + frame_name(frame.time.index) + ".png";
    const auto camera = static_cast<std::size_t>(std::ranges::find(views_, view.name) - views_.begin() + 1);
    std::string points = pack_points(view);
    piece.files.push_back(
        {"images/" + file,
         [color = *view.color, camera = view.camera] { return with_focal_length(encode_png(color), camera); },
         view.color->pixels.size() * sizeof(float)});
    views.push_back({{"camera", camera},
                     {"file", file},
                     {"pose", rigid_record(view.world_from_optical)},
                     {"points", points.size() / sizeof(ColmapPoint)}});
    piece.kept.push_back(text_file(points_name(camera, frame.time.index), std::move(points)));
  }
  piece.record["views"] = std::move(views);
  return piece;
}

std::string ColmapFormat::images(std::span<const ColmapView> views) const {
  std::string text = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then X Y POINT3D_ID of each point\n";
  std::size_t id = 0;
  for (const ColmapView& view : views) {
    text += view.image_line;
    const std::string bytes = read_kept(view.kept, view.kept_bytes);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(ColmapPoint)) {
      const auto point = binary_at<ColmapPoint>(bytes, at);
      text += (at == 0 ? "" : " ") + numbers_text({point.column_px, point.row_px}) + " " + std::to_string(++id);
    }
    text += "\n";
  }
  return text;
}

std::string ColmapFormat::points(std::span<const ColmapView> views) const {
  std::string text = "# POINT3D_ID X Y Z R G B ERROR IMAGE_ID POINT2D_IDX\n";
  std::size_t id = 0, image = 0;
  for (const ColmapView& view : views) {
    ++image;
    const std::string bytes = read_kept(view.kept, view.kept_bytes);
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(ColmapPoint)) {
      const auto point = binary_at<ColmapPoint>(bytes, at);
      const auto code = [&](std::size_t channel) { return static_cast<double>(point.rgb[channel]); };
      text += std::to_string(++id) + " " +
              numbers_text({point.x_m, point.y_m, point.z_m, code(0), code(1), code(2), 0}) + " " +
              std::to_string(image) + " " + std::to_string(at / sizeof(ColmapPoint)) + "\n";
    }
  }
  return text;
}

std::vector<DatasetFile> ColmapFormat::whole(std::span<const Record> records) const {
  std::vector<ColmapView> views;
  std::uint64_t bytes = 0;
  for (std::size_t frame = 0; frame < records.size(); ++frame) {
    for (const Record& view : records[frame].at("views")) {
      views.push_back({image_line(view, views.size() + 1), points_name(view.at("camera").get<std::size_t>(), frame),
                       sizeof(ColmapPoint) * view.at("points").get<std::uint64_t>()});
      bytes += views.back().kept_bytes;
    }
  }
  std::vector<DatasetFile> files;
  files.push_back(text_file("sparse/0/cameras.txt", cameras_));
  files.push_back({"sparse/0/images.txt", [this, views] { return images(views); }, bytes});
  files.push_back({"sparse/0/points3D.txt", [this, views] { return points(views); }, 2 * bytes});
  return files;
}

namespace {

const DatasetFormatRegistration kColmapRegistration(kColmap, [](double) -> std::unique_ptr<DatasetFormat> {
  return std::make_unique<ColmapFormat>();
});

}  // namespace
}  // namespace simvis
