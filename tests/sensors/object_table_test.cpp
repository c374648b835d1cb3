// The table of things that a camera sees: boxes and pixel counts against geometry, and against counts of rays into a
// world of one thing.
#include "sensors/camera/object_table.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <simvis/diagnostics.h>
#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "sensors/camera/pinhole_view.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

using ObjectRow = std::map<std::string, double>;

constexpr int kObjectWidth = 64, kObjectHeight = 48;

/// The rows of the table by object; of a stereo camera those of one view.
std::map<std::string, ObjectRow> object_rows(const Simulation& simulation, int view = -1) {
  const Measurement measurement = simulation.measurement("CAM");
  std::map<std::uint32_t, std::string> names;
  for (const SceneObject& each : simulation.objects()) names[each.instance] = each.name;
  const MeasuredArray* const object = measurement.find("object");
  REQUIRE(object != nullptr);
  std::map<std::string, ObjectRow> rows;
  for (std::size_t row = 0; row < object->count(); ++row) {
    if (view >= 0 && measurement.find("view")->number(row) != view) continue;
    ObjectRow& own = rows[names.at(static_cast<std::uint32_t>(object->number(row)))];
    for (const MeasuredArray& each : measurement.arrays) {
      if (each.kind == OutputKind::table_column) own[each.name] = each.number(row);
    }
  }
  return rows;
}

std::vector<double> box_of(const ObjectRow& row, const std::string& name) {
  return {row.at(name + "_x_min"), row.at(name + "_y_min"), row.at(name + "_x_max"), row.at(name + "_y_max")};
}

// Width 64 and 90 degrees: the focal length is 32 px. The camera is at the origin and looks along +x.
std::string straight_camera(const std::string& more = "", const char* type = "camera",
                            const char* outputs = "instance range boxes silhouettes") {
  return "<sensor type='" + std::string(type) + "' name='CAM' insert_at='ROOT' width='64' height='48' " +
         (more.find("fx=") == more.npos ? "hfov='90' outputs='" : "outputs='") + outputs + "' " + more + "/>";
}

std::string thing(const std::string& name, const std::string& shape, const std::string& offset) {
  return "<part name='" + name + "' insert_at='ROOT' shape='" + shape + " pose_offset='" + offset +
         "'/><element type='label' name='L_" + name + "' insert_at='ROOT' part='" + name + "' class='thing'" +
         " class_id='7'/>";
}

Simulation measured(const std::string& commands) {
  Simulation simulation = Simulation::from_string("<simvis>" + commands + "</simvis>");
  simulation.step();
  return simulation;
}

// A plate at 2 m whose face is 1.2 m wide and 0.8 m high: 32 px * 0.6 / 2 = 9.6 px to each side, 6.4 px up and down.
// Centres of pixels are at halves, so columns 32 - 9.5 to 32 + 9.5 show it: 23 to 41; rows 18 to 29.
const std::string kPlate = thing("PLATE", "box' size='0.1 1.2 0.8'", "2.05 0 0 0 0 0");
const std::vector<double> kPlateBox{22, 18, 42, 30};

TEST_CASE("the boxes of a plate are its pixels") {
  for (const char* const outputs : {"instance boxes silhouettes", "normal instance boxes silhouettes"}) {
    const Simulation simulation = measured(kPlate + straight_camera("", "camera", outputs));
    const auto rows = object_rows(simulation);
    REQUIRE(rows.size() == 1);
    const ObjectRow& plate = rows.at("PLATE");
    CHECK(plate.at("object_class") == 7);
    for (const char* const name : {"visible", "picture", "full"}) {
      CHECK(box_of(plate, name) == kPlateBox);
      CHECK(plate.at(name + std::string("_pixels")) == 20 * 12);
    }
    CHECK(plate.at("visible_fraction") == 1);
    CHECK(plate.at("truncated") == 0);
    CHECK(plate.at("distance_m") == doctest::Approx(2.05).epsilon(1e-12));
    // In the optical frame the box's own x is forward, its y to the left, its z up.
    CHECK(plate.at("box_z_m") == doctest::Approx(2.05).epsilon(1e-12));
    CHECK(plate.at("box_size_x_m") == doctest::Approx(0.1).epsilon(1e-6));  // sizes of meshes are float32
    CHECK(plate.at("box_size_y_m") == doctest::Approx(1.2).epsilon(1e-6));
    const glm::dquat q(plate.at("box_qw"), plate.at("box_qx"), plate.at("box_qy"), plate.at("box_qz"));
    CHECK(glm::length(q * glm::dvec3(1, 0, 0) - glm::dvec3(0, 0, 1)) < 1e-12);
    CHECK(glm::length(q * glm::dvec3(0, 0, 1) - glm::dvec3(0, -1, 0)) < 1e-12);
    // The nearest pixel is the first one right and below of the middle: half a pixel along each axis.
    CHECK(plate.at("nearest_m") == doctest::Approx(2 * std::sqrt(1 + 0.5 / (32 * 32))).epsilon(1e-6));
    const Measurement measurement = simulation.measurement("CAM");
    const MeasuredArray* const mask = measurement.find("silhouettes");
    REQUIRE(mask != nullptr);
    REQUIRE(mask->shape == OutputShape{48, 64, 1});
    for (int i = 0; i < 64 * 48; ++i) {
      const int x = i % 64, y = i / 64;
      CHECK(mask->number(static_cast<std::size_t>(i)) == (x >= 22 && x < 42 && y >= 18 && y < 30 ? 1 : 0));
    }
  }
}

TEST_CASE("what is hidden has a full box, and what shows a part of itself has its fraction") {
  // The screen at 1 m hides what is left of column 32: y from 0 to 3 m.
  const std::string screen =
      "<part name='SCREEN' insert_at='ROOT' shape='box' size='0.1 3 3' pose_offset='1.05 1.5 0 0 0 0'/>";
  const Simulation half = measured(kPlate + screen + straight_camera());
  const ObjectRow plate = object_rows(half).at("PLATE");
  CHECK(box_of(plate, "visible") == std::vector<double>{32, 18, 42, 30});
  CHECK(box_of(plate, "full") == kPlateBox);
  CHECK(plate.at("visible_pixels") == 10 * 12);
  CHECK(plate.at("visible_fraction") == 0.5);
  CHECK(object_rows(half).size() == 1);  // the screen has no class

  const std::string wall =
      "<part name='SCREEN' insert_at='ROOT' shape='box' size='0.1 6 6' pose_offset='1.05 0 0 0 0 0'/>";
  const ObjectRow hidden = object_rows(measured(kPlate + wall + straight_camera())).at("PLATE");
  CHECK(hidden.at("visible_pixels") == 0);
  CHECK(hidden.at("visible_fraction") == 0);
  CHECK(box_of(hidden, "picture") == kPlateBox);
  for (const double side : box_of(hidden, "visible")) CHECK(std::isnan(side));
  CHECK(std::isnan(hidden.at("nearest_m")));
}

TEST_CASE("the truncated share is that outside the picture, and what is outside has no row") {
  // Moved by 2 m to the left at 2 m: 32 columns to the left. Of columns -10 to 9, those from 0 on are in the picture.
  const std::string cut = thing("CUT", "box' size='0.001 1.2 0.8'", "2.0005 2 0 0 0 0");
  const ObjectRow row = object_rows(measured(cut + straight_camera())).at("CUT");
  CHECK(box_of(row, "full") == std::vector<double>{-10, 18, 10, 30});
  CHECK(box_of(row, "picture") == std::vector<double>{0, 18, 10, 30});
  CHECK(row.at("truncated") == 0.5);
  CHECK(row.at("visible_fraction") == 1);
  const std::string behind = thing("BEHIND", "box' size='0.1 1.2 0.8'", "-2.05 0 0 0 0 0"),
                    beside = thing("BESIDE", "box' size='0.1 1.2 0.8'", "2.05 4 0 0 0 0"),
                    near = thing("NEAR", "box' size='0.02 1 1'", "0.02 0 0 0 0 0");
  CHECK(object_rows(measured(behind + beside + near + straight_camera())).empty());
}

// Independent counts: rays of every pixel of the canvas into a world where one item is visible.

struct TestedLens {
  std::function<glm::dvec3(double x_px, double y_px)> ray;  ///< zero: the pixel sees nothing
  /// The part of a direction along the axis of its view, by which `near` is measured.
  std::function<double(const glm::dvec3& direction)> along_axis = [](const glm::dvec3& direction) {
    return direction.z;
  };
};
/// The frame in which the rays of a row start.
using RowPose = std::function<glm::dmat4(int row)>;

struct Count {
  int picture = 0, full = 0, unsure = 0;
};

/// Whether a camera shows what a ray has met: the front of a triangle, by the order of its corners, an exact shape, or
/// either side of a double-sided material.
bool is_shown(const DrawList& list, const glm::dmat4& world_from_view, const glm::dvec3& direction, const RayHit& hit) {
  const DrawItem& item = list.items[hit.item];
  const Mesh& mesh = *list.meshes[item.mesh];
  if (mesh.surface || list.materials[item.material]->double_sided) return true;
  const glm::dmat4 view_from_mesh = rigid_inverse(world_from_view) * list.world_from_node[item.transform];
  glm::dvec3 corner[3];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t vertex = mesh.indices[3 * std::size_t{hit.primitive} + k];
    corner[k] = glm::dvec3(view_from_mesh * glm::dvec4(mesh.positions[vertex], 1));
  }
  return glm::dot(glm::cross(corner[1] - corner[0], corner[2] - corner[0]), direction) < 0;
}

/// Whether each ray shows the item: a surface that is shown, at or beyond `near`.
std::vector<bool> shows(RayCaster& caster, const DrawList& list, const glm::dmat4& world_from_view,
                        const std::vector<glm::dvec3>& directions, const TestedLens& lens) {
  constexpr double kNear_m = 0.05;
  std::vector<bool> result(directions.size());
  std::vector<std::size_t> pending;
  std::vector<double> t_min_m;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (directions[i] == glm::dvec3(0)) continue;
    pending.push_back(i);
    t_min_m.push_back(kNear_m / lens.along_axis(directions[i]));
  }
  while (!pending.empty()) {
    std::vector<glm::dvec3> cast;
    for (const std::size_t i : pending) cast.push_back(directions[i]);
    std::vector<RayHit> hits(cast.size());
    caster.cast(world_from_view, cast, hits, t_min_m);
    std::vector<std::size_t> behind;
    t_min_m.clear();
    for (std::size_t k = 0; k < hits.size(); ++k) {
      if (std::isinf(hits[k].range_m)) continue;
      if (is_shown(list, world_from_view, cast[k], hits[k])) {
        result[pending[k]] = true;
        continue;
      }
      behind.push_back(pending[k]);
      t_min_m.push_back(hits[k].range_m);
    }
    pending = behind;
  }
  return result;
}

Count count_alone(const Simulation& simulation, std::uint32_t instance, const TestedLens& lens, const RowPose& pose,
                  bool drawn = false) {
  DrawList list = simulation.diagnostics().draw_list();
  const std::vector<SceneItem> items = simulation.items();
  for (std::size_t i = 0; i < items.size(); ++i) list.items[i].visible = items[i].instance == instance;
  const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
  caster->set_world(list);
  constexpr double kSnap_px = 1.0 / 256;
  Count count;
  for (int y = -kObjectHeight; y < 2 * kObjectHeight; ++y) {
    const glm::dmat4 world_from_view = pose(std::clamp(y, 0, kObjectHeight - 1));
    std::vector<glm::dvec3> centres, around;
    for (int x = -kObjectWidth; x < 2 * kObjectWidth; ++x) {
      centres.push_back(lens.ray(x + 0.5, y + 0.5));
      for (const double dx : {-kSnap_px, kSnap_px}) {
        if (!drawn) break;
        for (const double dy : {-kSnap_px, kSnap_px}) around.push_back(lens.ray(x + 0.5 + dx, y + 0.5 + dy));
      }
    }
    const std::vector<bool> met = shows(*caster, list, world_from_view, centres, lens),
                            met_around = shows(*caster, list, world_from_view, around, lens);
    for (int x = -kObjectWidth; x < 2 * kObjectWidth; ++x) {
      const auto i = static_cast<std::size_t>(x + kObjectWidth);
      const bool inside = x >= 0 && x < kObjectWidth && y >= 0 && y < kObjectHeight;
      count.full += met[i] ? 1 : 0;
      count.picture += met[i] && inside ? 1 : 0;
      bool differs = false;
      for (std::size_t k = 0; drawn && k < 4; ++k) differs |= met_around[4 * i + k] != met[i];
      count.unsure += differs ? 1 : 0;
    }
  }
  return count;
}

/// Compares all rows with the counts. Drawn pixels whose centre is within the snapping of an edge may differ.
int compare_counts(const Simulation& simulation, const std::map<std::string, ObjectRow>& rows, const TestedLens& lens,
                   const RowPose& pose, bool drawn) {
  int compared = 0, cut = 0;
  for (const SceneObject& object : simulation.objects()) {
    if (object.semantic == 0) continue;
    CAPTURE(object.name);
    const Count count = count_alone(simulation, object.instance, lens, pose, drawn);
    const auto row = rows.find(object.name);
    if (row == rows.end()) {
      CHECK(count.picture <= (drawn ? count.unsure : 0));
      continue;
    }
    const int unsure = drawn ? count.unsure : 0;
    CHECK(std::abs(row->second.at("picture_pixels") - count.picture) <= unsure);
    CHECK(std::abs(row->second.at("full_pixels") - count.full) <= unsure);
    ++compared;
    cut += count.full > count.picture ? 1 : 0;
  }
  CHECK(cut > 0);
  return compared;
}

TestedLens straight_lens() {
  return {[](double x_px, double y_px) { return glm::normalize(glm::dvec3((x_px - 32) / 32, (y_px - 24) / 32, 1)); }};
}

glm::dmat4 object_view(const Simulation& simulation) {
  glm::dmat4 world_from_sensor;
  simulation.sensor_pose("CAM", world_from_sensor);
  return world_from_sensor * sensor_from_view();
}

// Things in front, beside, above and behind, one partly nearer than `near`, one around the camera's axis far to the
// back.
const std::string kManyThings =
    thing("A", "box' size='0.5 0.7 0.9'", "2.4 0.3 0.1 10 20 30") +
    thing("B", "sphere' radius='0.5'", "1.5 -1.3 0.4 0 0 0") +
    thing("C", "cylinder' radius='0.2' length='2.5'", "1.1 0.9 0.7 40 10 0") +
    thing("PLANK", "box' size='4 0.3 0.05'", "1.6 -0.2 -0.3 0 3 4") +
    thing("D", "box' size='0.8 0.8 0.8'", "-1.5 0.9 0.3 0 0 15") +
    thing("E", "box' size='0.6 0.6 0.6'", "-0.3 -1.2 0.2 0 0 35") +
    // Its face runs from beside the camera ahead, so that `near` cuts it within the picture and shows its inside.
    thing("NEARLY", "box' size='1 0.02 0.06'", "0.5 0.05 0 0 0 0") +
    "<part name='SCREEN' insert_at='ROOT' shape='box' size='0.05 0.9 1.1' pose_offset='1.3 0.3 0.2 0 0 5'/>";

TEST_CASE("counts of pixels are those of rays into a world of one thing, of a pinhole camera") {
  for (const bool drawn : {true, false}) {
    const Simulation simulation =
        measured(kManyThings + straight_camera("", "camera", drawn ? "boxes" : "normal boxes"));
    const glm::dmat4 view = object_view(simulation);
    CHECK(compare_counts(
              simulation, object_rows(simulation), straight_lens(), [&](int) { return view; }, drawn) >= 4);
  }
}

TEST_CASE("counts of pixels are those of rays, of a fisheye beyond 90 degrees from its axis") {
  // Equidistant with 18 px for each radian: the picture's corners are 127 degrees off, beyond the lens's end at 110.
  constexpr double kFocal_px = 18;
  // Its views are the faces of a cube, and a direction belongs to the nearest axis.
  TestedLens lens{.ray = {}, .along_axis = [](const glm::dvec3& direction) {
                    return std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
                  }};
  lens.ray = [&](double x_px, double y_px) {
    const glm::dvec2 off((x_px - 32) / kFocal_px, (y_px - 24) / kFocal_px);
    const double angle = glm::length(off);
    if (angle > 110 * std::numbers::pi / 180) return glm::dvec3(0);
    return glm::dvec3(std::sin(angle) / angle * off, std::cos(angle));
  };
  const Simulation simulation =
      measured(kManyThings + straight_camera("distortion='kannala_brandt' fx='18'", "camera", "boxes"));
  const glm::dmat4 view = object_view(simulation);
  const auto rows = object_rows(simulation);
  CHECK(compare_counts(
            simulation, rows, lens, [&](int) { return view; }, false) >= 5);
  REQUIRE(rows.contains("E"));
  CHECK(rows.at("E").at("box_z_m") < 0);  // behind the plane of the lens, and seen
}

TEST_CASE("counts of pixels are those of rays, of both views of a stereo camera") {
  const Simulation simulation =
      measured(kManyThings + straight_camera("baseline='0.3'", "stereo_camera", "normal boxes"));
  const glm::dmat4 left = object_view(simulation);
  const glm::dmat4 right = glm::translate(left, {0.3, 0, 0});
  CHECK(compare_counts(
            simulation, object_rows(simulation, 0), straight_lens(), [&](int) { return left; }, false) >= 4);
  CHECK(compare_counts(
            simulation, object_rows(simulation, 1), straight_lens(), [&](int) { return right; }, false) >= 4);
}

TEST_CASE("counts of pixels are those of rays at the time of each row, of a rolling shutter") {
  const std::string mount = "<part name='CAR' insert_at='ROOT'/><element type='pose' name='DRIVE' insert_at='CAR'/>";
  const std::string camera =
      "<sensor type='camera' name='CAM' insert_at='CAR' width='64' height='48' hfov='90' outputs='normal boxes' "
      "row_time='0.001' rows_per_pose='1'/>";
  Simulation simulation = Simulation::from_string("<simvis>" + kManyThings + mount + camera + "</simvis>");
  simulation.step(std::chrono::milliseconds(100));
  simulation.set("DRIVE", "y", 0.4);
  simulation.step(std::chrono::milliseconds(100));
  const glm::dmat4 view = object_view(simulation);
  const auto pose = [&](int row) {
    const double share = (row - 47) * 0.001 / 0.1;
    return glm::translate(glm::dmat4(1), glm::dvec3(0, 0.4 * share, 0)) * view;
  };
  // Poses of rows are rounded differently, which may decide a pixel whose centre is at an edge.
  CHECK(compare_counts(simulation, object_rows(simulation), straight_lens(), pose, true) >= 4);
  // Rows see the camera up to 0.19 m farther to the right than the frame's own pose.
  const std::vector<SceneItem> items = simulation.items();
  const std::uint32_t a = std::ranges::find(items, "A", &SceneItem::part)->instance;
  const Count still = count_alone(simulation, a, straight_lens(), [&](int) { return view; }),
              moving = count_alone(simulation, a, straight_lens(), pose);
  CHECK(still.picture != moving.picture);
}

TEST_CASE("rays are cast within the boxes of hidden things only, and none without boxes") {
  const auto planned = [](const std::string& outputs) {
    const Simulation simulation = measured(kPlate + straight_camera("", "camera", outputs.c_str()));
    return simulation.diagnostics().frame_plan().casts.size();
  };
  CHECK(planned("color instance") == 0);
  CHECK(planned("color boxes") == 1);
}

TEST_CASE("only pixels that show something before the end of a thing's box take rays for its hidden part") {
  const Simulation simulation = measured(kPlate + straight_camera());
  const DrawList& list = simulation.diagnostics().draw_list();
  REQUIRE(list.items.size() == 1);
  const CameraLayout layout =
      camera_layout({.width_px = kObjectWidth, .height_px = kObjectHeight, .hfov_rad = std::numbers::pi / 2}, {});
  const CameraViews views = camera_views(layout, 1);
  const PixelCanvas canvas(layout, views, 0.05);
  const PixelRows rows{.count = kObjectHeight, .world_from_view = sensor_from_view()};
  const std::vector<std::uint32_t> nothing(std::size_t{kObjectWidth} * kObjectHeight, kNoItem);
  ObjectSilhouettes silhouettes(canvas);
  const auto found = [&](float shown_m) {
    const std::vector<float> range_m(nothing.size(), shown_m);
    return silhouettes.find(list, 0, std::array{0u}, {nothing, range_m, {&rows, 1}}, {}, {}).picture.pixels;
  };
  // The plate is in the picture from 2 to 2.1 m along the axis, and ends at 2.22 m in its corner.
  CHECK(found(std::numeric_limits<float>::infinity()) == 0);
  CHECK(found(2.3f) == 0);
  CHECK(silhouettes.rays() == 0);
  CHECK(found(1) == 20 * 12);
  CHECK(silhouettes.rays() >= 20 * 12);
}

// A table of two links and five meshes, of which one is turned; the legs stand beyond the picture's lower edge, and a
// screen hides a part of top and legs.
const std::string kTable = R"(<robot name="table">
  <link name="top">
    <visual><geometry><box size="0.8 1.2 0.06"/></geometry></visual>
    <visual><origin xyz="0.1 0.2 0.2" rpy="0 0 0.5"/><geometry><box size="0.3 0.2 0.3"/></geometry></visual></link>
  <link name="legs">
    <visual><origin xyz="-0.3 -0.5 -0.5"/><geometry><box size="0.06 0.06 1"/></geometry></visual>
    <visual><origin xyz="-0.3 0.5 -0.5"/><geometry><cylinder radius="0.04" length="1"/></geometry></visual>
    <visual><origin xyz="0.3 0 -0.5" rpy="0.3 0 0"/><geometry><box size="0.06 0.06 1"/></geometry></visual></link>
  <joint name="turn" type="revolute"><parent link="top"/><child link="legs"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint></robot>)";

Simulation table_scene(const TemporaryFolder& folder, const std::string& more, const std::string& level = "") {
  write_text(folder / "table.urdf", kTable);
  Simulation simulation = Simulation::from_string(
      "<simvis><part name='TABLE' insert_at='ROOT' file='table.urdf' pose_offset='1.5 0.1 -0.1 0 0 30'/>"
      "<element type='label' name='L' insert_at='ROOT' part='TABLE' class='table' class_id='7' " +
          level + "/>" + more + "</simvis>",
      {}, folder.path());
  simulation.step();
  return simulation;
}
const std::string kScreen =
    "<part name='SCREEN' insert_at='ROOT' shape='box' size='0.05 0.5 1.1' pose_offset='0.7 0.3 0 0 0 5'/>";

TEST_CASE("an object of several meshes has one row, whose counts are those of rays into a world of this object") {
  const TemporaryFolder folder;
  for (const bool drawn : {true, false}) {
    const Simulation simulation = table_scene(
        folder, kScreen + straight_camera("", "camera", drawn ? "instance boxes silhouettes" : "normal boxes"));
    const auto rows = object_rows(simulation);
    REQUIRE(rows.size() == 1);
    CHECK(compare_counts(
              simulation, rows, straight_lens(), [view = object_view(simulation)](int) { return view; }, drawn) == 1);
    const ObjectRow& row = rows.at("TABLE");
    CHECK(row.at("visible_pixels") > 50);
    CHECK(row.at("visible_pixels") < 0.8 * row.at("picture_pixels"));
    if (!drawn) continue;
    const Measurement measurement = simulation.measurement("CAM");
    const MeasuredArray &mask = *measurement.find("silhouettes"), &instance = *measurement.find("instance");
    double masked = 0, visible = 0;
    for (std::size_t pixel = 0; pixel < instance.count(); ++pixel) {
      masked += mask.number(pixel);
      visible += instance.number(pixel) == row.at("object") ? 1 : 0;
    }
    CHECK(masked == row.at("picture_pixels"));
    CHECK(visible == row.at("visible_pixels"));
  }
}

TEST_CASE("the box of an object of several links is along its own axes and follows its joints") {
  const TemporaryFolder folder;
  Simulation simulation = table_scene(folder, straight_camera());
  constexpr double kFloat_m = 1e-6;  // meshes of a metre in float32
  const auto check_size = [&](const glm::dvec3& size_m) {
    const ObjectRow row = object_rows(simulation).at("TABLE");
    const glm::dvec3 seen(row.at("box_size_x_m"), row.at("box_size_y_m"), row.at("box_size_z_m"));
    CHECK(glm::length(seen - size_m) < kFloat_m);
    // Turned by 30 degrees about z: x of the table, in the optical frame.
    const glm::dquat q(row.at("box_qw"), row.at("box_qx"), row.at("box_qy"), row.at("box_qz"));
    const double turn = std::numbers::pi / 6;
    CHECK(glm::length(q * glm::dvec3(1, 0, 0) - glm::dvec3(-std::sin(turn), 0, std::cos(turn))) < kFloat_m);
  };
  // Length: the top's. Width: the top's. Height: from the ends of the legs at -1 m to the upper face of the block.
  check_size({0.8, 1.2, 1.35});
  // Legs that stand at 0.583 m from the axis reach beyond the top's edge when they turn by 90 degrees: the first one's
  // outer face is then at x = 0.53, the second one's at -0.54.
  simulation.parameters().set(simulation.parameters().index("turn", "value"), 90);
  simulation.step();
  check_size({0.53 + 0.54, 1.2, 1.35});
}

TEST_CASE("level=\"link\" gives each link a row, and their silhouettes together cover that of the whole") {
  const TemporaryFolder folder;
  const auto whole = object_rows(table_scene(folder, kScreen + straight_camera()));
  const auto links = object_rows(table_scene(folder, kScreen + straight_camera(), "level='link'"));
  REQUIRE(links.size() == 2);
  const ObjectRow &top = links.at("top"), &legs = links.at("legs"), &table = whole.at("TABLE");
  CHECK(top.at("visible_pixels") + legs.at("visible_pixels") == table.at("visible_pixels"));
  CHECK(top.at("picture_pixels") + legs.at("picture_pixels") > table.at("picture_pixels"));  // they hide each other
  CHECK(std::max(top.at("full_y_max"), legs.at("full_y_max")) == table.at("full_y_max"));
  CHECK(std::min(top.at("full_x_min"), legs.at("full_x_min")) == table.at("full_x_min"));
}

TEST_CASE("trees of hidden things are made once, as long as their meshes are there") {
  const Simulation simulation =
      measured(kPlate + thing("CRATE", "box' size='0.3 0.3 0.3'", "3 0 0 0 0 0") + straight_camera());
  DrawList list = simulation.diagnostics().draw_list();
  REQUIRE(list.items.size() == 2);
  const CameraLayout layout =
      camera_layout({.width_px = kObjectWidth, .height_px = kObjectHeight, .hfov_rad = std::numbers::pi / 2}, {});
  const CameraViews views = camera_views(layout, 1);
  const PixelCanvas canvas(layout, views, 0.05);
  const PixelRows rows{.count = kObjectHeight, .world_from_view = sensor_from_view()};
  // Something that has no class hides both.
  const std::vector<std::uint32_t> nothing(std::size_t{kObjectWidth} * kObjectHeight, kNoItem);
  const std::vector<float> range_m(nothing.size(), 1);
  ObjectSilhouettes silhouettes(canvas);
  const auto find_both = [&] {
    silhouettes.begin(list, 1);
    for (const std::uint32_t item : {0u, 1u}) {
      CHECK(silhouettes.find(list, item, {&item, 1}, {nothing, range_m, {&rows, 1}}, {}, {}).picture.pixels > 0);
    }
  };
  for (int frame = 0; frame < 3; ++frame) {
    for (glm::dmat4& each : list.world_from_node) each = glm::translate(each, glm::dvec3(0, 0, 0.01));
    find_both();
  }
  CHECK(silhouettes.meshes_built() == 2);
  // Another mesh is new, and what was before is dropped.
  list.meshes[1] = std::make_shared<Mesh>(*list.meshes[1]);
  find_both();
  CHECK(silhouettes.meshes_built() == 3);
}

// A ball of radius 0.4 m at 3 m, half of which a wall hides; another one reaches out of the picture.
TEST_CASE("a cloud of points with a radius has the boxes of its shapes, one without what is shown") {
  const TemporaryFolder folder;
  std::ofstream(folder / "point.pcd") << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\n"
                                         "HEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 0\n";
  const std::string wall =
      "<part name='WALL' insert_at='ROOT' shape='box' size='0.1 2 2' pose_offset='2 1.1 0 0 0 0'/>";
  for (const std::string place : {"3 0 0 0 0 0", "3 -3 0 0 0 0"}) {
    CAPTURE(place);
    const auto row_of = [&](const std::string& attributes) {
      Simulation simulation = Simulation::from_string(
          "<part name='BALL' insert_at='ROOT' pose_offset='" + std::string(place) + "' " + attributes +
              "/><element type='label' name='L' insert_at='ROOT' part='BALL' class='ball' class_id='7'/>" + wall +
              straight_camera(),
          {}, folder.path());
      simulation.step();
      return object_rows(simulation).at("BALL");
    };
    const ObjectRow ball = row_of("shape='sphere' radius='0.4'"), cloud = row_of("file='point.pcd' point_radius='0.4'");
    CHECK(ball.at("full_pixels") > ball.at("visible_pixels"));
    for (const char* const name : {"visible", "picture", "full"}) {
      CAPTURE(name);
      CHECK(box_of(cloud, name) == box_of(ball, name));
      CHECK(cloud.at(name + std::string("_pixels")) == ball.at(name + std::string("_pixels")));
    }
    if (place[2] == '-') continue;  // a point outside the picture is not seen
    const ObjectRow point = row_of("file='point.pcd'");
    CHECK(point.at("visible_pixels") > 0);
    CHECK(point.at("full_pixels") == point.at("visible_pixels"));
  }
}

TEST_CASE("silhouettes need boxes") {
  const std::string message = error_of([] { measured(straight_camera("", "camera", "silhouettes")); });
  CHECK(message.find("silhouettes needs boxes, expected both") != std::string::npos);
}

}  // namespace
}  // namespace simvis
