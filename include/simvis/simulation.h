// The entry point for programs: load a scene, set parameters, step, and read what the sensors measured.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/device.h>
#include <simvis/diagnostics.h>
#include <simvis/error.h>
#include <simvis/export.h>
#include <simvis/image.h>
#include <simvis/measurement.h>
#include <simvis/parameters.h>
#include <simvis/progress.h>
#include <simvis/scan.h>
#include <simvis/sensor.h>
#include <simvis/simulation_desc.h>
#include <simvis/version.h>

namespace simvis {

struct BuiltScene;
struct SimulationImpl;
class SimulationServices;
class SimulationUse;
struct VectorSimulationImpl;
namespace ros {
class MessageOutlet;
}

/// A running simulation. All sensors are enabled at load; a disabled sensor is not rendered.
///
/// Frames    world and sensors: x forward, y left, z up (REP 103), metres.
/// Outlets   serve(), record() and join_dds() open consumers of frames. A frame is complete before they get it. If one
///           fails, the others still get the frame; then the step, or the finish() that completes the frame, throws
///           OutletError once. The frame stays made, and must not be tried again. The consumer that has failed is
///           closed: it gets no more frames, and can be opened again; a file ends with what it has. The next step goes
///           on.
/// Time      frame k is taken at round(k * 10^9 / rate) nanoseconds, unless SimulationDesc::frames_when_due or
///           step(dt) says otherwise; a sensor with `rate` f measures at the first frame at or after each j / f.
/// Errors    InputError for user input (scene, names, values) and for calls that are not allowed while a frame is under
///           way, see step_async(); MachineError for the device. A device that is lost, or does not end its work within
///           SIMVIS_MAX_WAIT_S, is given up: this step and all later ones throw, as do those of other simulations that
///           share it. A simulation that is loaded afterwards gets a new device.
/// Processes a process that was forked while a simulation lives has neither its threads nor its driver. There load(),
///           from_string() and all calls of the parent's simulations throw InputError, and the end of such a simulation
///           ends nothing.
/// Lifetime  returned references are valid as long as the simulation, also after it is moved; their content changes
///           with the next measurement, step or execute(). Returned spans are valid until the next step or execute(). A
///           simulation that was moved from may only be assigned to or destroyed; other calls throw InputError.
/// Threads   one thread at a time, which may be any thread: a call while another thread is inside a call throws
///           InputError and changes nothing. Several simulations may load and run in different threads at once, and
///           other threads may load plug-ins meanwhile; each simulation gives the same bytes as alone.
class SIMVIS_API Simulation {
 public:
  /// Loads a scene file. Throws InputError with FILE:LINE:COLUMN for any mistake in the scene or its parts, before
  /// anything is rendered; MachineError if no device fits.
  static Simulation load(const std::filesystem::path& scene, const SimulationDesc& desc = {});
  /// Loads a scene from text, with the errors of load(). Relative file names start at `folder`, and `name` stands for
  /// the file in messages.
  static Simulation from_string(std::string_view xml, const SimulationDesc& desc = {},
                                const std::filesystem::path& folder = ".", const std::string& name = "<string>");

  Simulation(Simulation&&) noexcept;             ///< takes over the other's simulation
  Simulation& operator=(Simulation&&) noexcept;  ///< takes over the other's simulation; the present one ends
  ~Simulation();                                 ///< a frame that is under way ends without results

  /// Sets a parameter, in the unit of its element's table (angles in degrees). It takes effect at the next step().
  /// Throws InputError and keeps the old value: no such element or parameter (the nearest name is suggested), not
  /// finite, out of range.
  void set(std::string_view element, std::string_view parameter, double value);
  /// The value of a parameter, in the unit of its element's table. Throws InputError: no such element or parameter.
  double get(std::string_view element, std::string_view parameter) const;

  /// Sets all six parameters of an element of type `pose`: the matrix parent_from_child, as Transform::matrix() has it.
  /// It takes effect at the next step(). Throws InputError and keeps the old values: no such element, an element of
  /// another type, or a matrix that is not rigid within 10^-6 (a rotation and a translation, finite, right-handed).
  void set_pose(std::string_view element, const glm::dmat4& parent_from_child);
  /// As set_pose() with a matrix, from a position and a rotation. Throws InputError also if the quaternion's length
  /// differs from 1 by more than 10^-6.
  void set_pose(std::string_view element, const glm::dvec3& position_m, const glm::dquat& rotation);

  /// Executes more commands: parts, elements and sensors are added to the running scene, or removed from it, and take
  /// effect at the next step(). References to what a removed sensor has measured end here. Relative file names start at
  /// `folder`, and `name` stands for the text in messages. All or nothing: if it throws InputError, with the place, the
  /// scene is unchanged. The text is logged in parameters().change_requests().
  void execute(std::string_view xml, const std::filesystem::path& folder = ".", const std::string& name = "<string>");

  /// Serves the simulation to other processes of this machine through shared memory, as docs/shared-memory.md says,
  /// until it is destroyed. From now on each step() begins with what clients wrote: it executes their change requests,
  /// sets their values and logs what it refuses. It ends by publishing its values and measurements; no client can
  /// delay it but those of `desc.lockstep`, for which step() waits: it throws MachineError naming the one that is not
  /// ready in time. Throws InputError: a name that is not allowed or is taken by a living simulation, a folder that
  /// does not exist, a second call. MachineError: no shared memory.
  void serve(const ServeDesc& desc);

  /// Records the frames of the next steps as ROS 2 messages in an MCAP file, as docs/messages.md says, until
  /// finish_recording() or the end of the simulation. Messages are encoded and written by a thread of its own. The file
  /// appears with the first frame and grows by whole chunks; skipped frames are not in it. If the
  /// file cannot be written, a step throws OutletError and the recording is over. Throws InputError: `desc.file` exists
  /// and is no MCAP file, two sensors would have the same topics, a recording is under way.
  void record(const RecordDesc& desc);
  /// Ends the recording: waits until all messages are written and gives the file its index. A pattern that no topic has
  /// matched gives a warning, unless the recording has no frame. Throws MachineError if the file cannot be written,
  /// InputError if there is no recording or, with the file complete, for a warning in a strict simulation. In all cases
  /// there is none afterwards.
  RecordReport finish_recording();

  /// Records the data packets that a real laser scanner would send in the next steps, in a capture file (pcap), as
  /// docs/device-packets.md says, until finish_packet_recording() or the end of the simulation. The file appears with
  /// the first frame; beside that of an Ouster device stands its metadata, in FILE.json. If the file cannot be written,
  /// a step throws OutletError and the recording is over. Throws InputError: no such scanner, its beams are not those
  /// of a device with packets, `desc.file` exists and is no capture file. Several files may be recorded at a time.
  void record_packets(const PacketRecordDesc& desc);
  /// Ends the first of these recordings. Throws MachineError if the file cannot be written, and that recording is over;
  /// InputError if there is none.
  PacketReport finish_packet_recording();

  /// Sends the data packets that a real laser scanner would send in the next steps by UDP, until stop_packets() or the
  /// end of the simulation; those of a frame go out together when it is complete. If the system cannot send, a step
  /// throws OutletError and the stream is over. Throws InputError as record_packets(), and if the address names no
  /// host.
  void send_packets(const PacketStreamDesc& desc);
  /// Ends that stream. Throws InputError if there is none.
  PacketReport stop_packets();

  /// Sends the frames of the next steps as ROS 2 messages by DDS, as docs/messages.md says, until leave_dds() or the
  /// end of the simulation. From now on each step() begins with what others sent: it executes their change requests
  /// with DdsDesc::requests, sets their values and says on /simvis/log what it refuses. If the simulation is served
  /// too, followers on other machines find it by that name. Messages are sent by a thread of its own; measurements that
  /// the network does not take in time are dropped and counted. If nothing can be sent, a step throws OutletError and
  /// the simulation is outside. ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS
  /// count as for nodes of ROS 2; settings of CYCLONEDDS_URI go before them. Returns who can reach the simulation.
  /// Throws InputError: no DDS in this build, a wrong value of a variable, no such folder, two sensors with the same
  /// topics, a second call. MachineError: no such domain.
  DdsReach join_dds(const DdsDesc& desc);
  /// Sends what waits, and leaves. Warnings and errors are as in finish_recording(). In all cases the simulation is
  /// then outside.
  DdsReport leave_dds();

  /// From now on, what is drawn for people shows this scan as the last one of `sensor`, instead of the sensor's own: in
  /// a simulation that shows what another process measures. `scan.world_from_sensor` says where the scanner stood.
  /// Throws InputError if there is no such sensor.
  void show_scan(std::string_view sensor, Scan scan);

  /// Adds a sensor that always has the pose of `sensor`, and that measures as `command` says; overrides do not apply to
  /// it. It compares several methods on one view: `command` is that of `sensor` with another name and other attributes
  /// (type and view stay; insert_at and pose_offset have no effect). All or nothing, as execute(). Throws InputError,
  /// also if there is no such sensor.
  void add_variant(std::string_view sensor, const Command& command);

  /// Turns a sensor on or off. Throws InputError if there is no such sensor.
  void enable(std::string_view sensor, bool on);

  /// Makes one frame: elements, flattening, planning, rendering, collecting.
  /// Throws InputError if a scanner cannot keep its tolerance: the frame then counts as not made, measured() is
  /// empty, and each sensor holds a complete measurement, its last one or that of this frame. The frame can be tried
  /// again. Throws OutletError if a consumer of the frame fails: the frame then counts as made.
  void step();

  /// As step(), but the frame is taken `dt` after the previous one, and the frames of later calls of step() follow it
  /// at the simulation's rate. The first frame is always taken at time 0, so its `dt` has no effect. Throws InputError
  /// if `dt` is not above 0, or beyond the clock's 292 years.
  void step(std::chrono::nanoseconds dt);

  /// The first half of a step: everything before the device's work, which continues after the return. Frames made in
  /// this way are byte for byte those of step(). The function begins with finish(), so that in
  ///
  ///   for (...) { simulation.set(...); simulation.step_async(); use(simulation.scan("FRONT")); }  simulation.finish();
  ///
  /// each scan is that of the previous frame, and is used while the device draws the next one. Until finish() only
  /// these functions may be called:
  ///   set(), get(), parameters()  for the next frame: new values take effect at the next step
  ///   next_frame()                the frame after the one under way
  ///   last_frame()                the frame before the one under way
  ///   measured(), measurement(), scan(), reading(), color(), depth(), picture()  of the previous frame
  /// Other calls throw InputError; Diagnostics lists the exceptions among its own functions.
  void step_async();

  /// Waits for the frame that is under way, if there is one, casts the remaining rays and publishes the results. Throws
  /// as step(): the frame then counts as not made, is no longer under way, and can be tried again.
  void finish();

  /// Skips the frame that step() would make next: nothing is rendered or measured, and results stay as they are.
  /// Only sensors with a history dependence on poses (`sweep`, `rolling_shutter`) record it; without such sensors the
  /// call costs nothing. A sensor that needs its last measurement, such as a camera with `flow_forward`, makes that of
  /// the last skipped frame when the next frame is not skipped, and does not show it. Frames made between skipped ones
  /// are byte for byte those of a run that makes all frames. Throws InputError if that is impossible: see
  /// require_skippable().
  void skip_frame();

  /// Throws InputError naming an enabled sensor whose measurements depend on earlier measurements: a scanner of method
  /// "auto", whose selection follows from earlier frames, or a visualization camera.
  void require_skippable() const;

  /// Saves the state between two frames: clock, parameters, physics, elements and sensors with their history. It
  /// begins with finish(), and changes no later frame. Frames after restore_state() are byte for byte those that follow
  /// now, on this machine and with this version of SimVis, in this simulation or in another one with the same settings
  /// and the same commands, those of execute() included. What sensors have measured is no part of it, except for
  /// measurements that are still under way and scans that visualization cameras show; nor are outlets and pulls of
  /// pointers. The bytes may be kept in a file. Throws InputError if a body has exploded, or naming a sensor or effect
  /// of a plug-in that depends on earlier frames and is not Stateful.
  std::string save_state();
  /// Goes on from a state of save_state(), any number of times. It begins with finish(). Sensors keep what they have
  /// measured last until they measure again; measured() is empty. All or nothing: changes nothing and throws InputError
  /// if the bytes are cut off, damaged, of another version or of another scene; MachineError if a sensor is on in the
  /// state that draws, and no device fits.
  void restore_state(std::string_view state);

  /// The time of the frame that the next step makes.
  FrameTime next_frame() const;

  /// The last frame that was made: finished, and not skipped. Empty before the first.
  std::optional<FrameTime> last_frame() const;

  /// The last scan of a sensor. Empty (no ranges) before its first measurement.
  /// Throws InputError if there is no such sensor, or if it gives no scan.
  const Scan& scan(std::string_view sensor) const;
  /// The last reading of a sensor that gives neither images nor a scan. No rows before its first measurement. Errors as
  /// scan().
  const Reading& reading(std::string_view sensor) const;
  /// The last measurement of a sensor: all its outputs, by name. It keeps its numbers when the sensor measures again.
  /// Throws InputError if there is no such sensor, or if a sensor of a plug-in gives something else than its type
  /// lists; so do color(), depth(), picture() and value(), and a step whose frames something consumes.
  Measurement measurement(std::string_view sensor) const;
  /// The last colour image of a sensor; of a stereo camera that of the left camera. Empty (no pixels) before its first
  /// measurement. It keeps its numbers, as all images that these functions return. Errors as scan().
  Image color(std::string_view sensor) const;
  /// The last depth image of a sensor, as color().
  Image depth(std::string_view sensor) const;
  /// An image of floats by the name of its output: "right", "disparity". Errors as scan().
  Image picture(std::string_view sensor, std::string_view name) const;
  /// One of a sensor's single numbers, by its name in the sensor's table: "voltage_v". NaN before the first
  /// measurement. Throws InputError if there is no such sensor, or if it has no number of that name.
  double value(std::string_view sensor, std::string_view name) const;
  /// As value(), but empty if the sensor has no number of that name.
  std::optional<double> find_value(std::string_view sensor, std::string_view name) const;

  /// The four arrays: descriptors, values, change requests, changes.
  Parameters& parameters();
  /// The four arrays, read only.
  const Parameters& parameters() const;

  /// world_from_sensor as of the last step(): rigid, in the sensor frame x forward, y left, z up. Returns false if the
  /// sensor stands in a part that is switched off. Throws InputError if there is no such sensor.
  bool sensor_pose(std::string_view sensor, glm::dmat4& world_from_sensor) const;

  /// Makes part_pose() known for a part, or for another insertion point, from the next step() on. Throws InputError if
  /// there is none of this name (the nearest name is suggested).
  void track_part(std::string_view part);

  /// world_from_part as of the last step(): rigid, without the scale along the path. Returns false if the part is
  /// switched off or scaled to nothing. Throws InputError if the part is not tracked.
  bool part_pose(std::string_view part, glm::dmat4& world_from_part) const;

  /// All sensors, in the order in which they were made.
  std::vector<SensorInfo> sensors() const;
  /// The items of the last step(), by the number that scans give them: Diagnostics::draw_list().items. Before the first
  /// step() those of the loaded scene.
  std::vector<SceneItem> items() const;
  /// The objects of the last step(), parents in front of what belongs to them, without ROOT. Before the first step()
  /// those of the loaded scene.
  std::vector<SceneObject> objects() const;
  /// Names of the sensors that measured in the last step().
  std::span<const std::string> measured() const;
  /// All warnings so far, in the order in which they came, each once: of parts, of the scene, and of steps. Each is one
  /// line "FILE[:LINE[:COLUMN]]: WHAT", without the word "warning".
  const std::vector<std::string>& warnings() const;
  /// Adds a warning of the program's own. Throws InputError if the simulation is strict.
  void warn(const std::string& warning);

  /// How the last step was planned and drawn, and what it cost. The view is valid until the simulation is destroyed.
  Diagnostics diagnostics() const;

 private:
  friend void send_messages(Simulation& simulation, ros::MessageOutlet* outlet);
  friend class SimulationServices;
  friend struct VectorSimulationImpl;
  explicit Simulation(std::unique_ptr<SimulationImpl> impl);
  SimulationUse impl() const;
  friend const BuiltScene& built_scene(const Simulation& simulation);
  friend const BuiltScene& updated_scene(Simulation& simulation);
  friend void read_all_content(Simulation& simulation);
  friend std::uint64_t frames_until(const Simulation& simulation, std::int64_t end_ns);
  std::unique_ptr<SimulationImpl> impl_;
};

}  // namespace simvis
