// The data of one frame that viewers get. They are taken right after the step; another thread makes messages of them.
// Images and scans share the numbers with the simulation; the rest is copied.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/measurement.h>
#include <simvis/scan.h>
#include <simvis/simulation.h>
#include "elements/sensed_physics.h"
#include "program/live/named_transforms.h"
#include "sensors/measured_table.h"

namespace simvis::live {

struct ViewSensor {
  std::string name, type, insert_at;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< all that have a value, with defaults
  std::vector<OutputSpec> outputs;                              ///< that it gives
  bool visualization = false;                                   ///< it sees what is drawn for people
  bool beams = false;                                           ///< an element of the scene draws its beams for people
};

struct ViewParameter {
  std::string element, type, insert_at, name, unit, summary;
  double min = 0, max = 0, value = 0;  ///< limits may be infinite
  bool full_turn = false;              ///< an angle without limits
  bool removed = false;                ///< its element is gone; the place stays, so that indices do
};

/// The scene as it stands between two changes of its structure.
struct ViewScene {
  std::string name;             ///< of the scene's file, without folder and ending
  std::uint64_t structure = 0;  ///< counts the scenes that a copier has made, from 1
  DrawList list;  ///< meshes and materials are shared with the simulation, and never change; all items are visible
  std::vector<SceneItem> items;      ///< as long as DrawList::items
  std::vector<SceneObject> objects;  ///< parents in front of what belongs to them
  NamedTransforms transforms;
  std::string list_json;                  ///< as `simvis-run --list --json` prints it
  std::vector<ViewSensor> sensors;        ///< in the order of the scene
  std::vector<ViewParameter> parameters;  ///< indices as in Parameters::values()
  std::vector<DrawnBody> bodies;          ///< of physics
};

struct ViewImage {
  std::uint32_t sensor = 0;  ///< index into ViewScene::sensors
  std::int64_t time_ns = 0;  ///< when it was taken
  MeasuredArray array;
};

struct ViewScan {
  std::uint32_t sensor = 0;
  Scan scan;
};

/// What a sensor gives besides images and scans.
struct ViewTable : MeasuredTable {
  std::uint32_t sensor = 0;
  bool one_row = false;  ///< in every measurement
};

struct ViewFrame {
  std::uint64_t index = 0;
  std::int64_t time_ns = 0;
  double step_ms = 0;
  std::shared_ptr<const ViewScene> scene;
  /// Shared between frames as long as nothing changes.
  std::shared_ptr<const std::vector<glm::dmat4>> world_from_node;
  std::shared_ptr<const std::vector<std::shared_ptr<const Material>>> materials;
  /// As long as DrawList::meshes of the scene; those that are deformed differ from the scene's in positions and
  /// normals.
  std::shared_ptr<const std::vector<std::shared_ptr<const Mesh>>> meshes;
  std::shared_ptr<const std::vector<LightItem>> lights;
  std::shared_ptr<const std::vector<std::uint32_t>> hidden;  ///< items that are not visible, ascending
  Environment environment;                                   ///< surroundings
  std::vector<double> values;                                ///< of all parameters
  std::vector<ViewImage> images;
  std::vector<ViewScan> scans;
  std::vector<ViewTable> tables;
  std::optional<DrawnPhysics> physics;  ///< empty unless it is wanted and the scene has bodies
  std::vector<std::string> warnings;    ///< all so far
  std::string plan;                     ///< as --explain prints it; empty unless it is wanted
};

/// Adds what a sensor has measured; its numbers are shared.
void add_measurement(std::uint32_t sensor, const Measurement& measurement, ViewFrame& frame);

/// What viewers look at; nothing else is copied.
struct ViewWants {
  std::set<std::string> sensors{};
  bool every_sensor = false;
  bool physics = false;
  bool plan = false;
  bool times = true;  ///< what took how long, by the clock; differs from run to run
};

/// Copies frames of one simulation.
///
/// Threads   copy() in the thread that steps; what it returns may be read by any thread, also while the simulation goes
///           on and after its end.
class ViewCopier {
 public:
  /// The frame of the last step, which took `step_ms`, with the last measurement of each wanted sensor that no frame
  /// had before. Throws InputError while a frame is under way.
  ViewFrame copy(Simulation& simulation, const FrameTime& time, double step_ms, const ViewWants& wants);

  /// The frame of the last step is not copied; what was measured in it is part of the next one that is, if no newer
  /// measurement is.
  void skip(const Simulation& simulation, const FrameTime& time);

  /// The next frame is that of another simulation. Its scene counts on.
  void restart() {
    restarted_ = true;
    measured_ns_.clear();
  }

 private:
  void follow_scene(const Simulation& simulation);
  bool is_new_scene(const DrawList& list, std::size_t changes);
  std::shared_ptr<const ViewScene> scene_;
  DrawList::Revisions revisions_;
  std::size_t changes_ = 0;                                       // executed commands
  std::map<std::string, std::int64_t, std::less<>> measured_ns_;  // when, by sensor; what no frame has yet
  bool restarted_ = false;
  std::shared_ptr<const std::vector<glm::dmat4>> world_from_node_;
  std::shared_ptr<const std::vector<std::shared_ptr<const Material>>> materials_;
  std::shared_ptr<const std::vector<std::shared_ptr<const Mesh>>> meshes_;
  std::shared_ptr<const std::vector<LightItem>> lights_;
  std::shared_ptr<const std::vector<std::uint32_t>> hidden_;
};

}  // namespace simvis::live
