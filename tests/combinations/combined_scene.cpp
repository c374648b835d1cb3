#include "tests/combinations/combined_scene.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include "scenegraph/pictures/png_bytes.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/temporary_folder.h"

namespace simvis::combined {
namespace {

std::string numbers(const double* first, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : " ") + format_number(first[i]);
  return text;
}

std::string attribute(std::string_view name, const std::string& value) {
  return " " + std::string(name) + "='" + value + "'";
}
std::string attribute(std::string_view name, double value) { return attribute(name, format_number(value)); }
std::string attribute(std::string_view name, const Place& place) {
  return attribute(name, numbers(place.number.data(), 6));
}

std::string numbered(char letter, int number) { return letter + std::to_string(number); }
std::string frame_name(int body) { return body == kNoParent ? "FRAME" : numbered('B', body); }

std::string shape_xml(const Body& body, const std::string& number) {
  constexpr std::string_view kNames[] = {"box", "sphere", "cylinder", "cone", "capsule", "plane"};
  const auto file = [&](const char* ending) { return attribute("file", "S" + number + ending); };
  switch (body.kind) {
    case ShapeKind::triangles:
      return file(".gltf") + attribute("up", "z");
    case ShapeKind::heights: {
      const double range_m[] = {body.heights.low_m, body.heights.high_m};
      return attribute("shape", "heightmap") + attribute("size", numbers(&body.size_m.x, 2)) +
             attribute("heights", "S" + number + ".png") + attribute("z_range", numbers(range_m, 2));
    }
    case ShapeKind::balls:
    case ShapeKind::discs:
      return file(".ply") + attribute("point_radius", body.radius_m) +
             attribute("point_shape", body.kind == ShapeKind::balls ? "sphere" : "disc");
    case ShapeKind::splats:
      return file(".ply");
    default:
      break;
  }
  std::string xml = attribute("shape", std::string(kNames[static_cast<std::size_t>(body.kind)]));
  if (body.kind == ShapeKind::box) return xml + attribute("size", numbers(&body.size_m.x, 3));
  if (body.kind == ShapeKind::plane) return xml + attribute("size", numbers(&body.size_m.x, 2));
  xml += attribute("radius", body.radius_m);
  return body.kind == ShapeKind::sphere ? xml : xml + attribute("length", body.length_m);
}

constexpr std::string_view kPoseParameters[] = {"x", "y", "z", "roll", "pitch", "yaw"};

std::string body_xml(const Body& body, int index) {
  const std::string number = std::to_string(index), shape = attribute("part", "S" + number);
  const std::string at_frame = attribute("insert_at", "B" + number), at_shape = attribute("insert_at", "S" + number);
  std::string xml = "<part" + attribute("name", "B" + number) + attribute("insert_at", frame_name(body.parent)) +
                    attribute("pose_offset", body.offset) + "/>\n";
  if (body.moves) {
    xml += "<element type='pose'" + attribute("name", "P" + number) + at_frame;
    for (std::size_t i = 0; i < 6; ++i) xml += attribute(kPoseParameters[i], body.move[0].number[i]);
    xml += "/>\n";
  }
  if (body.has_joint) {
    xml += "<element type='joint'" + attribute("name", "J" + number) + at_frame +
           attribute("kind", body.slides ? "prismatic" : "revolute") + attribute("axis", numbers(&body.axis.x, 3)) +
           attribute("value", body.joint[0]) + "/>\n";
  }
  xml += "<part" + attribute("name", "S" + number) + at_frame + shape_xml(body, number) + "/>\n";
  if (body.scale != glm::dvec3(1)) {
    xml += "<element type='scale'" + attribute("name", "Z" + number) + at_shape + attribute("x", body.scale.x) +
           attribute("y", body.scale.y) + attribute("z", body.scale.z) + "/>\n";
  }
  if (body.opacity != 1) {
    xml += "<element type='material'" + attribute("name", "M" + number) + at_frame + shape +
           attribute("opacity", body.opacity) + "/>\n";
  }
  if (body.has_class) {
    xml += "<element type='label'" + attribute("name", "L" + number) + at_frame + shape +
           attribute("class", "class" + number) + attribute("class_id", index + 1) + "/>\n";
  }
  return xml;
}

std::string scanner_xml(const SensorDesc& scanner) {
  std::string xml = attribute("samples", scanner.beams) + attribute("min_angle", -scanner.half_width_deg) +
                    attribute("max_angle", scanner.half_width_deg) + attribute("range_min", scanner.range_min_m) +
                    attribute("range_max", scanner.range_max_m) + attribute("method", scanner.method);
  if (scanner.method == "hybrid") xml += attribute("max_error_rel", 1e-4);
  if (scanner.rings > 1) {
    xml += attribute("vertical_samples", scanner.rings) + attribute("vertical_min_angle", -scanner.half_height_deg) +
           attribute("vertical_max_angle", scanner.half_height_deg);
  }
  if (scanner.sweep_s > 0) xml += attribute("sweep", scanner.sweep_s);
  if (scanner.truth) xml += attribute("truth", "range hit instance semantic normal velocity shape");
  return xml;
}

std::string image_xml(const SensorDesc& camera) {
  std::string xml = attribute("width", camera.width_px) + attribute("height", camera.height_px) +
                    attribute("hfov", camera.hfov_deg) + attribute("near", camera.near_m);
  if (camera.lens != "none") {
    const std::string_view names[] = {"k1", "k2", "k3", camera.lens == "kannala_brandt" ? "k4" : "p1", "p2"};
    xml += attribute("distortion", camera.lens);
    for (std::size_t i = 0; i < std::size(names); ++i) {
      if (camera.lens_k[i] != 0) xml += attribute(names[i], camera.lens_k[i]);
    }
  }
  if (camera.row_time_s > 0) xml += attribute("row_time", camera.row_time_s) + attribute("rows_per_pose", 1);
  return xml;
}

std::string camera_xml(const SensorDesc& camera, bool more_outputs) {
  std::string outputs = camera.outputs;
  const auto add = [&](const std::string& output) {
    if (more_outputs && !has_word(outputs, output)) outputs += " " + output;
  };
  for (const char* const output : {"color", "range", "instance", "semantic", "shape", "depth_error_bound"}) add(output);
  // It casts round shapes, as flow does.
  if (outputs.find("flow") != std::string::npos || camera.lens != "none" || has_word(outputs, "normal"))
    add("object_coordinates");
  std::string xml = image_xml(camera) + attribute("outputs", outputs) + attribute("layer", camera.layer);
  if (camera.kind == SensorKind::stereo_camera) xml += attribute("baseline", camera.baseline_m);
  return xml;
}

std::string sensor_xml(const SensorDesc& sensor, int index, const Writing& writing) {
  constexpr std::string_view kTypes[] = {"laser_scanner", "camera", "stereo_camera", "range",
                                         "keypoints",     "imu",    "odometry"};
  const bool other = sensor.kind == SensorKind::other;
  const std::string type =
      other ? ' ' + sensor.other : attribute("type", std::string(kTypes[static_cast<std::size_t>(sensor.kind)]));
  std::string xml = "<sensor" + type + attribute("name", numbered('C', index)) +
                    attribute("insert_at", frame_name(sensor.parent)) + attribute("pose_offset", sensor.offset) +
                    attribute("ignore", "none");
  if (writing.sensors_rate_hz > 0) xml += attribute("rate", writing.sensors_rate_hz);
  if (sensor.kind == SensorKind::scanner) xml += scanner_xml(sensor);
  if (sensor.kind == SensorKind::camera || sensor.kind == SensorKind::stereo_camera)
    xml += camera_xml(sensor, writing.more_outputs);
  if (sensor.kind == SensorKind::range) {
    xml += attribute("range_min", sensor.range_min_m) + attribute("range_max", sensor.range_max_m);
  }
  if (sensor.kind == SensorKind::imu) xml += attribute("orientation", std::string("on"));
  if (sensor.kind == SensorKind::keypoints) {
    xml += image_xml(sensor) + attribute("points", "B*") + attribute("radius", sensor.radius_m);
  }
  return xml + "/>\n";
}

constexpr std::string_view kMoreSensors = R"(
<sensor type='imu' name='N0' insert_at='FRAME' rate='30'/>
<sensor type='camera' name='N1' insert_at='FRAME' width='16' height='12' outputs='color depth normal' rate='15'/>
<sensor type='laser_scanner' name='N2' insert_at='FRAME' samples='21' method='planar'/>
<sensor type='sonar' name='N3' insert_at='FRAME' rays='32'/>
)";
constexpr std::string_view kEventCamera = R"(
<sensor type='event_camera' name='N4' insert_at='FRAME' width='8' height='6'/>
)";

void write_triangles(const std::filesystem::path& file, const Body& body) {
  std::vector<float> corners;
  for (const Triangle& triangle : body.triangles) {
    for (const glm::dvec3& corner : triangle) {
      for (int i = 0; i < 3; ++i) corners.push_back(static_cast<float>(corner[i]));
    }
  }
  test::GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", corners)}})["material"] = 0;
  builder.append("materials", {{"doubleSided", !body.single_sided}});
  write_text(file, builder.text());
}

void write_heights(const std::filesystem::path& file, const Heights& heights) {
  std::vector<std::uint8_t> rows;
  for (const std::uint16_t code : heights.codes) {
    rows.push_back(static_cast<std::uint8_t>(code >> 8));
    rows.push_back(static_cast<std::uint8_t>(code & 0xff));
  }
  write_text(file, png_bytes({.width = static_cast<std::uint32_t>(heights.columns),
                              .height = static_cast<std::uint32_t>(heights.rows),
                              .bits = 16,
                              .channels = 1},
                             rows));
}

void write_points(const std::filesystem::path& file, const std::vector<CloudPoint>& points) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) + "\n";
  for (const char* const name : {"x", "y", "z", "nx", "ny", "nz"}) text += std::string("property float ") + name + "\n";
  text += "end_header\n";
  for (const CloudPoint& point : points) {
    text += numbers(&point.at_m.x, 3) + " " + numbers(&point.normal.x, 3) + "\n";
  }
  write_text(file, text);
}

void write_file(const std::filesystem::path& folder, const Body& body, int index) {
  const std::string name = "S" + std::to_string(index);
  switch (body.kind) {
    case ShapeKind::triangles:
      return write_triangles(folder / (name + ".gltf"), body);
    case ShapeKind::heights:
      return write_heights(folder / (name + ".png"), body.heights);
    case ShapeKind::balls:
    case ShapeKind::discs:
      return write_points(folder / (name + ".ply"), body.points);
    case ShapeKind::splats:
      return write_text(folder / (name + ".ply"), test::splat_file(body.splats));
    default:
      return;
  }
}

bool moves(const CombinedScene& scene) {
  return std::ranges::any_of(scene.bodies, [](const Body& body) { return body.moves || body.has_joint; });
}

void write_trajectory(const CombinedScene& scene, const std::filesystem::path& file) {
  std::string head = "time_s", rows[kFrames];
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    rows[frame] = format_number(static_cast<double>(frame) / kRate_hz);
    for (const Setting& setting : settings_of(scene, frame)) {
      if (frame == 0) head += "," + setting.element + "." + setting.parameter;
      rows[frame] += "," + format_number(setting.value);
    }
  }
  write_text(file, head + "\n" + rows[0] + "\n" + rows[1] + "\n");
}

Place mirrored(Place place) {
  for (const std::size_t i : {1u, 3u, 5u}) place.number[i] = -place.number[i];
  return place;
}

void mirror(CombinedScene& scene) {
  scene.frame = mirrored(scene.frame);
  for (Body& body : scene.bodies) {
    body.offset = mirrored(body.offset);
    for (Place& move : body.move) move = mirrored(move);
    body.axis.y = -body.axis.y;
    if (!body.slides) {
      for (double& value : body.joint) value = -value;
    }
    for (Triangle& triangle : body.triangles) {
      for (glm::dvec3& corner : triangle) corner.y = -corner.y;
      std::swap(triangle[1], triangle[2]);
    }
    // Cells are divided the other way in a mirror: this is another surface, with heights in the same places.
    const Heights heights = body.heights;
    for (std::size_t i = 0; i < heights.codes.size(); ++i) {
      const auto columns = static_cast<std::size_t>(heights.columns);
      const std::size_t row = i / columns, mirrored_row = static_cast<std::size_t>(heights.rows) - 1 - row;
      body.heights.codes[i] = heights.codes[mirrored_row * columns + i % columns];
    }
    for (CloudPoint& point : body.points) {
      point.at_m.y = -point.at_m.y;
      point.normal.y = -point.normal.y;
    }
    for (test::FileSplat& splat : body.splats) {
      splat.center_m.y = -splat.center_m.y;
      splat.rotation *= glm::dvec4(-1, 1, -1, 1);
    }
  }
  for (SensorDesc& sensor : scene.sensors) sensor.offset = mirrored(sensor.offset);
}

void enlarge(Place& place) {
  for (std::size_t i = 0; i < 3; ++i) place.number[i] *= 2;
}

void enlarge(CombinedScene& scene) {
  enlarge(scene.frame);
  for (Body& body : scene.bodies) {
    enlarge(body.offset);
    for (Place& move : body.move) enlarge(move);
    if (body.slides) {
      for (double& value : body.joint) value *= 2;
    }
    body.size_m *= 2;
    body.radius_m *= 2;
    body.length_m *= 2;
    for (Triangle& triangle : body.triangles) {
      for (glm::dvec3& corner : triangle) corner *= 2;
    }
    body.heights.low_m *= 2;
    body.heights.high_m *= 2;
    for (CloudPoint& point : body.points) point.at_m *= 2;
    for (test::FileSplat& splat : body.splats) {
      splat.center_m *= 2;
      splat.sigma_m *= 2;
    }
  }
  for (SensorDesc& sensor : scene.sensors) {
    enlarge(sensor.offset);
    sensor.range_min_m *= 2;
    sensor.range_max_m *= 2;
    sensor.near_m *= 2;
    sensor.baseline_m *= 2;
    sensor.radius_m *= 2;
  }
}

void split(CombinedScene& scene) {
  for (Body& body : scene.bodies) {
    std::vector<Triangle> pieces;
    for (const auto& [a, b, c] : body.triangles) {
      // The middle of a side, as a float: the pieces are the surface to test,
      // and lie beside the whole one by a rounding.
      const glm::dvec3 middle(glm::vec3((a + b) * 0.5));
      pieces.push_back({a, middle, c});
      pieces.push_back({middle, b, c});
    }
    body.triangles = pieces;
  }
}

CombinedScene without_body(CombinedScene scene, std::size_t removed) {
  const int index = static_cast<int>(removed), above = scene.bodies[removed].parent;
  scene.bodies.erase(scene.bodies.begin() + index);
  const auto renumber = [&](int& parent) {
    if (parent == index) parent = above;
    if (parent > index) --parent;
  };
  for (Body& body : scene.bodies) renumber(body.parent);
  for (SensorDesc& sensor : scene.sensors) renumber(sensor.parent);
  return scene;
}

}  // namespace

std::vector<Setting> settings_of(const CombinedScene& scene, std::size_t frame) {
  std::vector<Setting> settings;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const std::string number = std::to_string(i);
    for (std::size_t k = 0; k < 6 && body.moves; ++k) {
      settings.push_back({"P" + number, std::string(kPoseParameters[k]), body.move[frame].number[k]});
    }
    if (body.has_joint) settings.push_back({"J" + number, "value", body.joint[frame]});
  }
  return settings;
}

void write_scene(const CombinedScene& scene, const std::filesystem::path& folder, const Writing& writing) {
  struct Block {
    std::string xml;
    int parent = kNoParent, body = kNoParent;
  };
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const int index = static_cast<int>(i);
    blocks.push_back({body_xml(scene.bodies[i], index), scene.bodies[i].parent, index});
    write_file(folder, scene.bodies[i], index);
  }
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    blocks.push_back({sensor_xml(scene.sensors[i], static_cast<int>(i), writing), scene.sensors[i].parent});
  }
  std::string xml = "<scene>\n<part name='FRAME' insert_at='ROOT'" + attribute("pose_offset", scene.frame) + "/>\n";
  test::Random random(writing.order);
  std::vector<int> written{kNoParent};
  while (!blocks.empty()) {
    std::vector<std::size_t> possible;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (std::ranges::find(written, blocks[i].parent) != written.end()) possible.push_back(i);
    }
    const std::size_t next = possible[writing.order == 0 ? 0 : random.below(possible.size())];
    xml += blocks[next].xml;
    if (blocks[next].body != kNoParent) written.push_back(blocks[next].body);
    blocks.erase(blocks.begin() + static_cast<std::ptrdiff_t>(next));
  }
  if (writing.more_sensors) xml += kMoreSensors;
  if (writing.more_sensors && !has_many_heights(scene)) xml += kEventCamera;
  write_text(folder / "scene.xml", xml + "</scene>\n");
  if (moves(scene)) write_trajectory(scene, folder / "trajectory.csv");
}

bool has_word(const std::string& words, const std::string& word) {
  return (" " + words + " ").find(" " + word + " ") != std::string::npos;
}

bool has_many_heights(const CombinedScene& scene) {
  return std::ranges::any_of(scene.bodies, [](const Body& body) { return body.heights.columns == kManyHeights; });
}

CombinedScene related(const CombinedScene& scene) {
  CombinedScene other = scene;
  if (scene.relation == Relation::moved) other.frame = {{3, -2, 1, 10, -20, 70}};
  if (scene.relation == Relation::doubled) enlarge(other);
  if (scene.relation == Relation::mirrored) mirror(other);
  if (scene.relation == Relation::split) split(other);
  return other;
}

std::vector<CombinedScene> simpler(const CombinedScene& scene) {
  std::vector<CombinedScene> all;
  const auto changed = [&](const auto& change) {
    CombinedScene other = scene;
    change(other);
    all.push_back(std::move(other));
  };
  for (std::size_t i = 0; i < scene.sensors.size() && scene.sensors.size() > 1; ++i) {
    changed([&](CombinedScene& other) { other.sensors.erase(other.sensors.begin() + static_cast<std::ptrdiff_t>(i)); });
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) all.push_back(without_body(scene, i));
  if (scene.frame != Place{}) changed([](CombinedScene& other) { other.frame = {}; });
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const auto change = [&](bool can, const auto& change_body) {
      if (can) changed([&](CombinedScene& other) { change_body(other.bodies[i]); });
    };
    change(body.moves, [](Body& other) { other.moves = false; });
    change(body.has_joint, [](Body& other) { other.has_joint = false; });
    change(body.scale != glm::dvec3(1), [](Body& other) { other.scale = glm::dvec3(1); });
    change(body.opacity != 1, [](Body& other) { other.opacity = 1; });
    change(body.single_sided, [](Body& other) { other.single_sided = false; });
    change(body.has_class, [](Body& other) { other.has_class = false; });
    const auto change_list = [&](auto list) {
      for (std::size_t k = 0; k < (body.*list).size() && (body.*list).size() > 1; ++k) {
        change(true, [&](Body& other) { (other.*list).erase((other.*list).begin() + static_cast<std::ptrdiff_t>(k)); });
      }
    };
    change_list(&Body::triangles);
    change_list(&Body::points);
    change_list(&Body::splats);
    change(std::ranges::any_of(body.heights.codes, [](std::uint16_t code) { return code != 0; }),
           [](Body& other) { std::ranges::fill(other.heights.codes, std::uint16_t{0}); });
  }
  for (std::size_t i = 0; i < scene.sensors.size(); ++i) {
    const SensorDesc& sensor = scene.sensors[i];
    const auto change = [&](bool can, const auto& change_sensor) {
      if (can) changed([&](CombinedScene& other) { change_sensor(other.sensors[i]); });
    };
    change(sensor.sweep_s > 0, [](SensorDesc& other) { other.sweep_s = 0; });
    change(sensor.truth, [](SensorDesc& other) { other.truth = false; });
    change(sensor.row_time_s > 0, [](SensorDesc& other) { other.row_time_s = 0; });
    change(sensor.lens != "none", [](SensorDesc& other) { other.lens = "none"; });
    change(sensor.layer != "visible", [](SensorDesc& other) { other.layer = "visible"; });
    for (std::size_t at = sensor.outputs.find(' '); at != std::string::npos; at = sensor.outputs.find(' ', at + 1)) {
      const std::size_t end = std::min(sensor.outputs.find(' ', at + 1), sensor.outputs.size());
      if (sensor.lens != "none" && sensor.outputs.substr(at, end - at) == " instance") continue;
      change(true, [&](SensorDesc& other) { other.outputs.erase(at, end - at); });
    }
  }
  return all;
}

}  // namespace simvis::combined
