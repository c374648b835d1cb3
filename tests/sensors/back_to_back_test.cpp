// A wall of two single-sided faces, back to back: each sensor and method sees the face in front, as in a scene without
// the other face. Axes: one part or two, the order of the faces, the first corner, mirrored parts, and faces that
// coincide or are one unit in the last place apart.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <simvis/device.h>
#include <simvis/simulation.h>
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

constexpr float kWall_m = 3;
// A laser may hit either face: a unit in the last place of their depth, over the cosine of the widest beam, and the
// rounding of the range, which is as large again.
constexpr double kEitherFace_m = 2 * 0x1p-22 / 0.8;

struct Wall {
  bool two_parts = false, back_first = false, mirrored = false;
  std::size_t first_corner = 0;  ///< of the triangles of the back
  float apart = 0;               ///< the back is so many units in the last place farther away
  bool has_back = true;
};

/// A square of 2 m, perpendicular to x, seen from -x or from +x.
void add_face(std::vector<float>& corners, float x_m, bool from_behind, std::size_t first_corner, bool mirrored) {
  constexpr float kSquare[4][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};  // y and z
  constexpr std::size_t kTriangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (const auto& triangle : kTriangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (first_corner + k) % 3;
      // The node of a mirrored part mirrors it back: its fronts run counter-clockwise in the file.
      const auto& [y, z] = kSquare[triangle[from_behind != mirrored ? 2 - next : next]];
      corners.insert(corners.end(), {x_m, mirrored ? -y : y, z});
    }
  }
}

void write_part(const std::filesystem::path& file, const std::vector<float>& corners, bool mirrored) {
  GltfBuilder builder;
  builder.primitive({{"POSITION", builder.accessor<float>("VEC3", corners)}})["material"] = 0;
  builder.append("materials", {{"doubleSided", false}});
  if (mirrored) builder.root["nodes"][0]["scale"] = {1, -1, 1};
  write_text(file, builder.text());
}

/// Writes the parts of the wall and returns their commands.
std::string write_wall(const Wall& wall, const std::filesystem::path& folder) {
  std::array<std::vector<float>, 2> faces;  // front, back
  add_face(faces[0], kWall_m, false, 0, wall.mirrored);
  const float back_m =
      wall.apart == 0 ? kWall_m : std::nextafter(kWall_m, wall.apart * std::numeric_limits<float>::infinity());
  if (wall.has_back) add_face(faces[1], back_m, true, wall.first_corner, wall.mirrored);
  if (wall.back_first) std::swap(faces[0], faces[1]);
  if (!wall.two_parts) {
    faces[0].insert(faces[0].end(), faces[1].begin(), faces[1].end());
    faces[1].clear();
  }
  std::string xml;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].empty()) continue;
    const std::string name = "WALL" + std::to_string(i);
    write_part(folder / (name + ".gltf"), faces[i], wall.mirrored);
    xml += "<part name='" + name + "' file='" + name +
           ".gltf' up='z' insert_at='ROOT'/>\n<element type='temperature' " + "name='HEAT" + std::to_string(i) +
           "' insert_at='" + name + "' temperature='400'/>\n";
  }
  return xml;
}

struct SensorOfWall {
  const char* attributes;
  double tolerance = 0;  ///< of all its numbers
};

constexpr const char* kNames = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";
const SensorOfWall kSensors[] = {
    {"type='camera' outputs='color depth range object_coordinates'"},
    {"type='camera' outputs='depth normal object_coordinates flow_backward'"},
    {"type='camera' outputs='depth layers occlusion flow_backward flow_forward'"},
    {"type='camera' outputs='depth' layer='first'"},
    {"type='camera' outputs='depth' layer='first_opaque'"},
    {"type='camera' outputs='depth' distortion='brown_conrady' k1='-0.1'"},
    {"type='camera' outputs='depth' distortion='kannala_brandt'"},
    {"type='camera' outputs='depth normal' row_time='0.001'"},
    {"type='camera' outputs='color' supersampling='4'"},
    {"type='stereo_camera' outputs='depth disparity'"},
    {"type='stereo_camera' outputs='depth normal disparity'"},
    {"type='rgbd_camera' outputs='color depth depth_state'"},
    {"type='thermal_camera' outputs='temperature'"},
    {"type='event_camera'"},
    {"type='tof_camera' outputs='depth range amplitude'", kEitherFace_m},
    {"type='keypoints' points='HIDDEN'"},
    {"type='laser_scanner' samples='31' method='raycast' truth='range normal'", kEitherFace_m},
    {"type='laser_scanner' samples='31' method='hybrid'", kEitherFace_m},
    {"type='laser_scanner' samples='31' method='planar'", kEitherFace_m},
    {"type='laser_scanner' samples='31' method='nearest'", kEitherFace_m},
    {"type='range' range_max='9'", kEitherFace_m},
    {"type='psd' range_max='9'", kEitherFace_m},
    {"type='sonar' rays='64'", kEitherFace_m},
};

std::string sensors_xml() {
  std::string xml;
  for (std::size_t i = 0; i < std::size(kSensors); ++i) {
    const std::string attributes = kSensors[i].attributes;
    const bool image = attributes.find("camera") != attributes.npos || attributes.find("keypoints") != attributes.npos;
    const bool fisheye = attributes.find("kannala") != attributes.npos;
    xml += "<sensor name='" + std::string(1, kNames[i]) + "' insert_at='ROBOT' " + attributes +
           (image ? " width='16' height='12'" : "") +
           (image && !fisheye ? " hfov='60'"
            : fisheye         ? " fx='14'"
                              : "") +
           (attributes.find("laser") != attributes.npos ? " min_angle='-25' max_angle='25'" : "") + "/>\n";
  }
  return xml;
}

/// What the sensors measure in the second of two frames between which they move.
std::vector<Measurement> measured(const Wall& wall) {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::from_string(
      "<s>" + write_wall(wall, folder.path()) +
          "<part name='HIDDEN' insert_at='ROOT' pose_offset='4 0.1 0.1 0 0 0'/><part name='ROBOT' insert_at='ROOT'/>"
          "<element type='pose' name='MOVE' insert_at='ROBOT'/>" +
          sensors_xml() + "</s>",
      {}, folder.path());
  simulation.step();
  simulation.set("MOVE", "y", 0.1);
  simulation.step();
  std::vector<Measurement> all;
  for (std::size_t i = 0; i < std::size(kSensors); ++i)
    all.push_back(simulation.measurement(std::string(1, kNames[i])));
  return all;
}

/// Ids are numbered in the order of the parts.
bool is_id(const std::string& output) {
  return output.find("instance") != output.npos || output.find("item") != output.npos ||
         output.find("shape") != output.npos;
}

/// Numbers that differ by more than the tolerance.
std::size_t differences(const Measurement& found, const Measurement& expected, double tolerance) {
  std::size_t differing = 0;
  for (const MeasuredArray& each : expected.arrays) {
    if (is_id(each.name)) continue;
    const MeasuredArray* const other = found.find(each.name);
    if (other == nullptr || other->count() != each.count()) return std::numeric_limits<std::size_t>::max();
    for (std::size_t i = 0; i < each.count(); ++i) {
      const double a = each.number(i), b = other->number(i);
      const bool same = a == b || (std::isnan(a) && std::isnan(b)) || std::abs(a - b) <= tolerance;
      differing += !same;
    }
  }
  return differing;
}

TEST_CASE("a wall of two faces back to back is seen as its front alone, by each sensor and method") {
  const Device shared;  // all simulations use it, which is not opened again for each
  std::size_t compared = 0;
  for (const bool mirrored : {false, true}) {
    const std::vector<Measurement> front = measured({.mirrored = mirrored, .has_back = false});
    // The reference sees the wall, and so would show a hole.
    for (std::size_t i = 0; i < 8; ++i) CHECK(front[i].find("depth")->number(6 * 16 + 8) == doctest::Approx(kWall_m));
    for (const bool two_parts : {false, true}) {
      for (const bool back_first : {false, true}) {
        for (const std::size_t first_corner : {0u, 1u, 2u}) {
          for (const float apart : {0.0f, 1.0f, -1.0f}) {
            const std::vector<Measurement> both =
                measured({two_parts, back_first, mirrored, first_corner, apart, true});
            for (std::size_t i = 0; i < both.size(); ++i) {
              CAPTURE(kSensors[i].attributes);
              CAPTURE(mirrored);
              CAPTURE(two_parts);
              CAPTURE(back_first);
              CAPTURE(first_corner);
              CAPTURE(apart);
              CHECK(differences(both[i], front[i], kSensors[i].tolerance) == 0);
              ++compared;
            }
          }
        }
      }
    }
  }
  CHECK(compared == 72 * std::size(kSensors));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
