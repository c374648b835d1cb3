// Replays the scene of a served simulation in this process, frame by frame.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "simvis/sharing/followed_host.h"

namespace simvis {

/// The scene is that of the host: the commands of its log, and the values of its last finished frame. The host's
/// sensors do not measure here. To the scene come the commands of an own file, such as cameras for people and beams,
/// which show the scans that the host has measured. A host that ends is waited for: its successor has another scene,
/// and the own commands are executed in that.
class Follower {
 public:
  /// `follow` is as --follow has it, `own_scene` a scene file, or empty. Throws what followed_host() throws.
  Follower(const std::string& follow, std::string own_scene, SimulationDesc desc);

  /// Waits for the host and makes its scene. Throws Stopped if a signal comes, and InputError for the own file.
  Simulation open();

  /// Called in advance() several times a second while there is no new frame; `has_host` is false while the host has
  /// ended and there is no other one.
  using Waiting = std::function<void(bool has_host)>;
  /// Waits for the next finished frame of the host and brings the simulation to it. Empty: a signal has come.
  /// The index of the frame is the host's; after a restart of the host it goes on behind the last one.
  std::optional<FrameTime> advance(Simulation& simulation, const Waiting& waiting = {});

  /// Asks the host to set a parameter, by its index here. Returns false if it belongs to the own scene. Throws
  /// InputError if there is no host.
  bool set(const Simulation& simulation, std::size_t parameter, double value);
  /// Asks the host to execute commands. Throws InputError if it cannot take them, or there is none.
  void request(const std::string& xml);
  /// The last measurement of one of the host's sensors; empty: it has not measured, or has ended. `outputs` are those
  /// of the sensor.
  std::optional<Measurement> latest_measurement(const std::string& sensor, std::span<const OutputSpec> outputs);

  /// How many simulations it has made: advance() puts a new one in the place of that of a host that has ended.
  std::uint64_t builds() const { return builds_; }

  /// Makes the frame that advance() has prepared, at the host's time.
  void step(Simulation& simulation);

 private:
  void connect(const Waiting& waiting = {});
  void reconnect(Simulation& simulation, const Waiting& waiting);
  void require_host() const;
  void read_frame();
  Simulation build();
  void add_own(Simulation& simulation);
  /// Entries of the log, as text and as what it says.
  struct Changes {
    std::string xml;
    std::vector<Command> commands;
  };
  Changes next_changes();
  void replay(Simulation& simulation);
  void follow(Simulation& simulation, std::span<const Command> commands);
  void note_scanners(std::span<const Command> commands);
  void copy_values(Simulation& simulation);
  void take_value(Parameters& parameters, std::size_t parameter, double value);
  void show_scans(Simulation& simulation);

  std::string name_, own_scene_;
  SimulationDesc desc_;
  std::unique_ptr<FollowedHost> host_;
  FollowedHost::Frame frame_;                   // of the host
  std::vector<double> values_;                  // of that frame, by the host's parameter
  std::vector<double> copied_;                  // as values_, when they were copied last
  std::vector<std::size_t> own_parameter_;      // by the host's parameter
  std::uint64_t log_position_ = 0;              // behind the entries that were replayed
  std::set<std::string> scanners_;              // that elements show
  std::map<std::string, std::uint64_t> shown_;  // number of the scan that is shown, by scanner
  std::optional<std::int64_t> stepped_ns_;      // host's time of the last step of this simulation
  std::uint64_t builds_ = 0;
  std::uint64_t first_frame_ = 0, last_frame_ = 0;  // index of the host's frame 0, and of the last frame
  bool has_refused_ = false;                        // a value of the host that its parameter cannot have
  bool has_host_ = false;                           // it is connected
  bool own_is_required_ = true;                     // a mistake in the own file is an error, and not only a warning
};

}  // namespace simvis
