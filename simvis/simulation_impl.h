// The state of a simulation and the stages of a frame.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <simvis/simulation_desc.h>
#include <simvis/state_archive.h>
#include "engine/base/input_log.h"
#include "engine/base/process_use.h"
#include "simvis/device_costs.h"
#include "simvis/frame.h"
#include "simvis/lazy_device.h"
#include "simvis/live_scene.h"
#include "simvis/ros/command_inputs.h"
#include "simvis/sensed_world.h"
#include "simvis/sensor_states.h"
#include "simvis/sharing/frame_outlets.h"
#include "simvis/step_stages.h"
#include "simvis/time/timeline.h"
#include "simvis/tracked_parts.h"
#include "simvis/view_layer.h"

namespace simvis {

/// What a simulation was read from.
struct ReadInputs {
  void add(const InputLog& log);

  std::vector<std::filesystem::path> files;  ///< sorted
  EnvironmentLog environment;                ///< variables
};

/// Sensors that were due in a skipped frame and whose next measurement needs that of this frame. The list of the layer
/// of sensors is still that of this frame.
struct SkippedSensors {
  std::vector<std::size_t> sensors;  ///< by index
  FrameTime frame;
};

struct SimulationImpl : Observations {
  /// `name` stands for the scene in messages.
  SimulationImpl(const SimulationDesc& desc, std::span<const Command> commands, std::string name);

  // The scene and what follows its changes: simulation_impl.cpp.
  /// Throws InputError while a frame is under way.
  SimulationImpl& idle();
  /// Follows a change of the scene.
  void follow_scene();
  void execute_request(std::span<const Command> commands);
  std::vector<SceneItem> items();
  std::vector<SceneObject> objects();
  /// Sensors that do not exist yet are on.
  bool is_on(std::string_view sensor) const;
  void enable(std::string_view sensor, bool on);
  /// What a sensor that has been switched on needs: its device, and what has been postponed.
  void load_for(const Sensor& sensor);
  ViewLayer& layer_of(const BuiltSensor& sensor) { return sensor.sensor->visualization() ? *visualization : sensing; }
  /// Returns false if the sensor is mounted in a part that is switched off.
  bool pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor);
  const BuiltSensor& sensor(std::string_view sensor) const { return scene.built.sensors[sensors.index(sensor)]; }
  ObservedScan scan(std::string_view sensor) const override { return sensors.scan(sensor); }
  bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const override;

  // The stages of a frame: frame_stages.cpp.
  FrameTime next_frame() const;
  void step();
  void step(std::chrono::nanoseconds dt);
  void start();
  void finish();
  bool needs_pictures() const;
  void read_pictures();
  /// Reads postponed shapes. `needed_by` as Scene::read_shapes().
  void read_shapes(const std::string& needed_by);
  void move_elements(const FrameTime& time);
  void draw_visualization(const FrameTime& time);
  /// Flattens the layer's scene.
  void flatten(ViewLayer& layer);
  void plan_due_sensors(ViewLayer& layer, bool for_people, const FrameTime& time);
  void plan_sensor(ViewLayer& layer, std::size_t sensor, const FrameTime& time);
  /// Also updates the pose of the sensor if it is due.
  DueState due_state(std::size_t sensor, const FrameTime& time);
  void render(ViewLayer& layer, const FrameTime& time);
  void measure(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results);
  void measure(ViewLayer& layer, ViewLayer::Entry& entry, const FrameTime& time, std::span<const PassResult> results);
  /// Whether consumers get a measurement of the sensor in this frame: its own, or one that was under way.
  bool arrives(const ViewLayer::Entry& entry, const FrameTime& time);
  std::vector<PlacedSensor> placed_sensors();
  void offer_frame(std::span<const PlacedSensor> placed);

  // skipped_frames.cpp
  void skip_frame();
  void require_skippable() const;
  void measure_skipped();

  // simulation_state.cpp
  std::string save_state();
  void restore_state(std::string_view bytes);
  void archive(StateArchive& state);
  void archive_elements(StateArchive& state);
  void archive_sensors(StateArchive& state);

  // step_warnings.cpp
  void warn(const std::string& warning);
  void warn_before_measuring();
  void warn_of_unseen_splats(const ViewLayer& layer);
  void warn_of_blocked_scan(const BuiltSensor& sensor);
  void warn_of_empty_views(const ViewLayer& layer, std::span<const PassResult> results);

  ProcessUse process;                   // first: nothing is begun in a process that cannot work
  std::atomic<std::thread::id> user{};  // the thread whose call is under way; none: no thread
  SimulationDesc desc;
  bool reads_all = false;  // see read_all_content()
  Timeline timeline;

  LiveScene scene;
  ReadInputs inputs;
  CommandSources command_sources;
  std::int64_t moved_to_ns = 0;  // the time to which elements have moved

  LazyDevice device;
  DeviceCosts device_costs;
  ViewLayer sensing;
  std::optional<ViewLayer> visualization;  // set if the scene has a visualization sensor
  SensedWorlds sensed;
  SensorStates sensors;
  TrackedParts tracked_parts;

  FrameTime frame;                // under way, or the last one that was begun
  std::optional<FrameTime> made;  // the last one that was finished
  bool under_way = false;         // `frame` is not finished; the device may be working
  SkippedSensors skipped;
  StepStages stages;
  FrameOutlets outlets;
};

}  // namespace simvis
