// A simulation in shared memory: takes what clients wrote before a frame, and publishes the frame.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/parameters.h>
#include <simvis/sensor.h>
#include <simvis/simulation_desc.h>
#include "exchange/clients/host.h"
#include "simvis/scene_builder.h"
#include "simvis/sharing/allowed_folders.h"
#include "simvis/sharing/frame_outlet.h"

namespace simvis {

/// The bridge between a running scene and its shared memory. Elements and parameters have the same ids in both.
class Serving : public FrameOutlet {
 public:
  /// Throws InputError: the name is not allowed or taken, a folder is not there. MachineError: no memory.
  Serving(const ServeDesc& desc, const BuiltScene& scene);

  const std::string& served_name() const { return desc_.name; }

  /// Executes commands of clients, in the scene that `execute` changes.
  using Execute = std::function<void(std::span<const Command>)>;
  /// Executes requests, then sets values, as clients wrote them. What is refused stands in the log.
  void take(BuiltScene& scene, const Execute& execute);

  std::string_view name() const override { return "shared memory"; }
  std::string_view stage() const override { return "publish"; }
  /// Publishes the measurements and the values of a frame and wakes clients.
  void frame(const Frame& frame) override;

  /// Waits until all clients of ServeDesc::lockstep are ready for this frame. Throws MachineError naming the client
  /// that is not, after ServeDesc::lockstep_timeout_s.
  void wait_for_clients(const FrameTime& time);

  /// Shows clients the values that the host itself has set since the last call.
  void follow_values(const Parameters& parameters);

 private:
  void publish(const PlacedSensor& placed, const FrameTime& time);
  void follow_scene(const BuiltScene& scene);
  void follow_elements(const Parameters& parameters);
  void follow_sensors(const BuiltScene& scene);
  void execute(const ChangeRequest& request, const BuiltScene& scene, const Execute& execute);
  void set(Parameters& parameters, const WrittenValue& written);
  void set(Parameters& parameters, const WrittenElement& written);
  void refuse_value(const std::string& why, std::uint32_t client);
  void take_over(const Parameters& parameters, std::size_t parameter);

  ServeDesc desc_;
  AllowedFolders folders_;
  SharedHost host_;
  std::size_t changes_ = 0;                     // of the scene's log that are in the shared one
  std::vector<bool> removed_;                   // by element
  std::map<std::size_t, std::size_t> sensors_;  // from BuiltSensor::id to the id in the shared memory
  int refused_values_ = 0;                      // in this frame
  std::vector<double> values_;                  // as the shared memory has them
};

}  // namespace simvis
