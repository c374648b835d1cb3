// The settings of a simulation: rate, seed, threads, device, and attributes that override those of the scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <simvis/device_info.h>
#include <simvis/progress.h>
#include <simvis/scene.h>

namespace simvis {

/// An attribute that overrides that of all sensors of one type, before the scene is built.
struct AttributeOverride {
  std::string sensor_type,           ///< the type of the sensors
      attribute;                     ///< the attribute's name
  std::optional<std::string> value;  ///< as in XML; empty: the attribute of the scene is removed, the default applies
  std::string origin;                ///< its source, for messages: "--method"; empty: "SENSOR_TYPE.ATTRIBUTE"
};

/// The settings of a simulation. Simulation::load() throws InputError for a value that is not allowed.
struct SimulationDesc {
  double rate_hz = 15;  ///< frames per simulated second, finite and above 0
  /// Frames come exactly when a sensor that is on and has a rate is due. While no such sensor is on, they come at
  /// `rate_hz`.
  bool frames_when_due = false;
  std::uint64_t seed = 0;  ///< of all random numbers
  /// Number of threads that work on a step, including the calling thread: they cast rays, cull views and prepare
  /// meshes. 0: as many as the machine has; above 1024: InputError. Simulations of one process with the same number
  /// share one thread pool. Results are the same bytes for every number. The Vulkan driver has threads of its own.
  unsigned threads = 0;
  DeviceDesc device;                         ///< the device that renders
  std::vector<AttributeOverride> overrides;  ///< applied in this order
  /// Packages that parts name, searched before ROS_PACKAGE_PATH and other places. A folder that does not exist:
  /// InputError.
  std::vector<PackageFolder> packages{};
  /// Whether elements that move by themselves do so. false: their values come from elsewhere, as in a simulation that
  /// follows another one.
  bool elements_move = true;
  bool strict = false;  ///< a warning is an InputError, at load and in a step
  /// The sensors that are on at first, see Simulation::enable(); empty: all. What only others need is not loaded. An
  /// unknown name: InputError.
  std::vector<std::string> sensors{};
  /// Called while parts are read (load, execute), while meshes that a step shows for the first time are prepared, and
  /// every 100 steps of physics within a frame.
  ProgressCallback progress{};
};

/// How a running simulation is served to other processes, see Simulation::serve().
struct ServeDesc {
  /// 1 to 63 of A-Z a-z 0-9 . _ -. One living simulation of this machine has it.
  std::string name;
  /// Change requests may name part files below these folders only, and relative names start at the first. Empty:
  /// requests cannot insert part files.
  std::vector<std::filesystem::path> folders{};
  std::vector<std::string> lockstep{};  ///< names of the clients that each frame waits for
  /// Whether programs with this process's effective group may connect too. false: those of its user only.
  bool group = false;
  double lockstep_timeout_s = 10;  ///< how long a frame waits for them by the wall clock, above 0
};

/// How a running simulation is recorded, see Simulation::record().
struct RecordDesc {
  std::filesystem::path file;  ///< a new file, or an MCAP file that is replaced; with a slash at its end a bag folder
  /// Patterns of topics, in which * stands for any text and ? for any character. Empty: all topics but those that hold
  /// the same measurement as another in another form.
  std::vector<std::string> topics{};
  /// The policy for a file that is slower than the simulation, once 256 MiB wait to be written. false: a step waits.
  /// true: it drops measurements, which are counted.
  bool drop = false;
};

/// How a running simulation takes part in a domain of DDS, see Simulation::join_dds().
struct DdsDesc {
  /// 0 to 232. Empty: as ROS_DOMAIN_ID or else CYCLONEDDS_URI says, by default 0.
  std::optional<std::uint32_t> domain{};
  std::vector<std::string> topics{};  ///< as RecordDesc::topics
  /// Whether measurements that the network loses are sent again. false: ROS 2's quality of service for sensor data.
  bool reliable = false;
  /// Whether change requests of participants are executed, which insert and remove parts, elements and sensors. false:
  /// each is refused. Values of parameters and commands of robots are taken either way.
  bool requests = false;
  /// Change requests may name part files below these folders only, and relative names start at the first. Empty:
  /// requests cannot insert part files.
  std::vector<std::filesystem::path> folders{};
  /// The node of ROS 2 that the simulation is: NAME or /NAMESPACE/NAME, as ROS allows. Its topics are NODE/set,
  /// NODE/request, NODE/log and the services of parameters.
  std::string node = "simvis";
};

/// Who can reach a simulation by DDS, see Simulation::join_dds().
struct DdsReach {
  std::uint32_t domain = 0;               ///< of the simulation
  std::vector<std::string> interfaces{};  ///< names of the network interfaces that it uses
  /// Whether participants of this machine alone reach it: its interfaces are loopback. false: those of every network
  /// that leads to this machine may.
  bool is_local = false;
};

/// What a simulation has sent and received by DDS.
struct DdsReport {
  std::uint64_t messages = 0,  ///< sent
      dropped = 0,             ///< measurements that were not sent, because the network is slower than the simulation
      bytes = 0,               ///< sent
      received = 0,            ///< messages of others: values and requests
      refused = 0;             ///< of those that were received
};

/// The content of a finished recording.
struct RecordReport {
  std::filesystem::path file;  ///< as in RecordDesc
  std::uint64_t messages = 0,  ///< in the file
      dropped = 0,             ///< measurements that RecordDesc::drop kept out of it
      bytes = 0;               ///< of the file
};

/// How the data packets of a laser scanner are recorded, see Simulation::record_packets().
struct PacketRecordDesc {
  std::filesystem::path file;  ///< a new file, or a capture file (pcap) that is replaced
  std::string sensor{};        ///< the scanner's name; empty: the scene's only laser scanner
};

/// Where the data packets of a laser scanner are sent, see Simulation::send_packets().
struct PacketStreamDesc {
  std::string address;   ///< HOST or HOST:PORT; the port is by default that of the device's maker
  std::string sensor{};  ///< the scanner's name; empty: the scene's only laser scanner
};

/// What was recorded or sent of a laser scanner.
struct PacketReport {
  std::string sensor;         ///< its name
  std::uint64_t packets = 0,  ///< data packets
      bytes = 0;              ///< of the file, or of the packets that were sent
};

}  // namespace simvis
