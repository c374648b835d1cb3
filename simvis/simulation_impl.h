// The state of a simulation and the stages of a frame.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <simvis/device.h>
#include <simvis/scan.h>
#include <simvis/simulation_desc.h>
#include "engine/base/input_log.h"
#include "engine/base/process_use.h"
#include "simvis/frame.h"
#include "simvis/live_scene.h"
#include "simvis/ros/command_inputs.h"
#include "simvis/sensed_world.h"
#include "simvis/sharing/frame_outlets.h"
#include "simvis/step_stages.h"
#include "simvis/time/timeline.h"
#include "simvis/view_layer.h"

namespace simvis {

struct SimulationImpl : Observations {
  /// `name` stands for the scene in messages.
  SimulationImpl(const SimulationDesc& desc, std::span<const Command> commands, std::string name);

  FrameTime next_frame() const;
  void step();
  void step(std::chrono::nanoseconds dt);
  void start();
  void finish();
  void skip_frame();
  void require_skippable() const;
  SimulationImpl& idle();
  void add_inputs(const InputLog& log);
  std::vector<SceneItem> items();
  void track_part(std::string_view part);
  std::shared_ptr<Mount> add_mount(std::string_view part);
  bool part_pose(std::string_view part, glm::dmat4& world_from_part) const;
  bool needs_pictures() const;
  void read_pictures();
  void move_elements(const FrameTime& time);
  void draw_visualization(const FrameTime& time);
  void plan_due_sensors(ViewLayer& layer, bool for_people, const FrameTime& time);
  void render(ViewLayer& layer, const FrameTime& time);
  void measure(ViewLayer& layer, const FrameTime& time, std::span<const PassResult> results);
  void measure(ViewLayer& layer, ViewLayer::Entry& entry, const FrameTime& time, std::span<const PassResult> results);
  DueState due_state(std::size_t sensor, const FrameTime& time);
  std::vector<double> rates() const;
  void warn(const std::string& warning);
  void warn_before_measuring();
  void warn_of_unseen_splats(const ViewLayer& layer);
  void warn_of_empty_views(const ViewLayer& layer, std::span<const PassResult> results);
  void follow_scene();
  void follow_sensors();
  void follow_tracked_parts();
  void execute_request(std::span<const Command> commands);
  void measure_skipped();
  void plan_sensor(ViewLayer& layer, std::size_t sensor, const FrameTime& time);
  void discard_measurements();
  void offer_frame(std::span<const PlacedSensor> placed);
  std::vector<PlacedSensor> placed_sensors();
  const Measurement& measurement(std::size_t sensor);
  ViewLayer& layer_of(const BuiltSensor& sensor) { return sensor.sensor->visualization() ? *visualization : sensing; }
  bool pose(const BuiltSensor& sensor, glm::dmat4& world_from_sensor);
  std::size_t index(std::string_view sensor) const;
  const BuiltSensor& sensor(std::string_view name) const { return scene.built.sensors[index(name)]; }
  const Measurement& measurement(std::string_view name) { return measurement(index(name)); }

  ObservedScan scan(std::string_view name) const override;
  bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const override;

  struct State {
    std::size_t sensor = 0;  // BuiltSensor::id
    bool enabled = true;
    std::uint64_t frames = 0;
    glm::dmat4 world_from_sensor{1.0};       // at its last measurement
    std::vector<std::string> effects;        // names of the effects it has had
    bool rate_checked = false;               // whether the frames keep its rate
    std::optional<Measurement> measurement;  // the last one, checked, since somebody has read it
  };

  const CostModel& costs(const SensorType& type);

  struct ShownScan {
    Scan scan;
    std::uint64_t count = 0;
  };

  ProcessUse process;                   // first: nothing is begun in a process that cannot work
  std::atomic<std::thread::id> user{};  // the thread whose call is under way; none: no thread
  std::string name;
  double rate_hz;
  bool frames_when_due;
  bool elements_move;
  ProgressCallback progress;
  bool reads_all_pictures = false;  // see read_all_pictures()
  Timeline timeline;
  LiveScene scene;
  CommandSources command_sources;
  std::int64_t moved_to_ns = 0;  // the time to which elements have moved
  std::vector<State> states;     // as long as scene.built.sensors
  std::filesystem::path cache;
  std::vector<std::filesystem::path> inputs;  // files that were read, sorted
  EnvironmentLog environment;                 // variables that were read
  Device device;
  std::map<std::string, std::shared_ptr<Mount>, std::less<>> tracked_parts;  // null: it was removed
  std::optional<CostModel> device_costs;                                     // set when a sensor first requests them
  ViewLayer sensing;
  SensedWorlds sensed;
  std::optional<ViewLayer> visualization;  // set if the scene has a visualization sensor
  FrameTime frame;                         // under way, or the last one that was begun
  std::optional<FrameTime> made;           // the last one that was finished
  bool under_way = false;                  // `frame` is not finished; the device may be working
  std::vector<std::string> measured;       // names of the sensors that measured in this frame
  StepStages stages;
  std::map<std::size_t, ShownScan> shown_scans;  // by BuiltSensor::id
  FrameOutlets outlets;
  bool instrumented;
  std::vector<SensorCost> sensor_costs;
  // Sensors that were due in a skipped frame and whose next measurement needs that of this frame, by index. The list of
  // `sensing` is still that of this frame.
  std::vector<std::size_t> skipped_sensors;
  FrameTime skipped_frame;
};

}  // namespace simvis
