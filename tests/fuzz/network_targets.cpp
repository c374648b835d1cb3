// What other processes send: messages of DDS, browsers and Foxglove, HTTP requests, and the shared memory.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "exchange/clients/host.h"
#include "exchange/messages/cdr.h"
#include "exchange/messages/description.h"
#include "exchange/messages/types/follow_types.h"
#include "exchange/messages/types/std_types.h"
#include "exchange/messages/types/system_types.h"
#include "program/live/foxglove.h"
#include "program/live/foxglove_peer.h"
#include "program/live/server.h"
#include "program/live/view_hub.h"
#include "sensors/measured_table.h"
#include "simvis/ros/command_inputs.h"
#include "simvis/scene_builder.h"
#include "simvis/sharing/output_message.h"
#include "simvis/sharing/parameter_services.h"
#include "tests/clients/shared_host.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/live/web_client.h"
#include "tests/support/parts/arm_urdf.h"

namespace simvis::fuzz {
namespace {

// Messages of DDS to SimVis, by the first byte.
void read_cdr(Input input) {
  InputBytes bytes(input);
  const std::uint8_t kind = bytes.byte();
  const std::string_view message = text_of(bytes.rest());
  switch (kind % 5) {
    case 0:
      ros::decode<ros::String>(message);
      break;
    case 1:
      ros::decode<ros::ParameterEvent>(message);
      break;
    case 2:
      ros::decode<ros::ChangeLog>(message);
      break;
    case 3:
      ros::decode<ros::HostFrame>(message);
      break;
    default:
      ros::decode<ros::HostMeasurement>(message);
  }
}

// A measurement of a host, as a follower takes it: decoded, and read as the table or the scan that it says it is.
void read_measurement(Input input) {
  const std::optional<Measurement> measurement = to_measurement(ros::decode<ros::HostMeasurement>(text_of(input)));
  if (!measurement) return;
  const bool fits = fits_together(*measurement);
  const std::optional<Scan> scan = to_scan(*measurement);
  if (!fits) return;
  const MeasuredTable table = measured_table(*measurement);
  SIMVIS_ASSERT(!scan || table.rows() == scan->range_m.size());
}

/// A vehicle and an arm that take commands.
const std::string& commanded_scene() {
  static const std::string scene = [] {
    const std::filesystem::path arm = input_folder() / "arm.urdf";
    std::ofstream(arm) << test::kArm;
    return R"(<element type="physics" name="PHYSICS" insert_at="ROOT"/>
      <part name="CAR" insert_at="ROOT" shape="box" size="0.6 0.3 0.2"/>
      <element type="vehicle" name="DRIVE" insert_at="CAR" mass="10" clearance="0.05"/>
      <element type="velocity_command" name="C" insert_at="CAR" vehicle="DRIVE" topic="/cmd_vel"/>
      <part name="ARM" insert_at="ROOT" file=")" +
           arm.string() + R"("/>
      <element type="robot" name="ROBOT" insert_at="ARM" velocity_joints="elbow"/>
      <element type="joint_command" name="J" insert_at="ARM" robot="ROBOT"/>)";
  }();
  return scene;
}

// A command of a robot by the first byte, and what it does in the next frame.
void read_command(Input input) {
  static BuiltScene scene = build_scene(parse_commands(commanded_scene(), "fuzz.xml", ""));
  static CommandSources sources;
  InputBytes bytes(input);
  const std::vector<CommandInput> inputs = sources.inputs(scene);
  const CommandInput& taken = inputs[bytes.byte() % inputs.size()];
  constexpr std::int64_t kNow_ns = 10'000'000'000;
  apply_command(sources.of(scene), scene.parameters, taken, text_of(bytes.rest()), kNow_ns);
  // What was accepted can be followed: an element that gives up warns.
  const std::size_t warnings = scene.scene.warnings().size();
  for (std::int64_t time_ns = kNow_ns;
       const std::int64_t later_ns : {10'500'000'000, 11'000'000'000, 15'000'000'000, 1'000'000'000'000}) {
    follow_commands(sources.of(scene), scene, std::exchange(time_ns, later_ns), later_ns);
  }
  SIMVIS_ASSERT(scene.scene.warnings().size() == warnings);
}

// A request to a service of the parameters, by the first byte.
void read_request(Input input) {
  static BuiltScene scene = build_scene(parse_commands(commanded_scene(), "fuzz.xml", ""));
  InputBytes bytes(input);
  static ParameterNames names;
  const std::vector<ParameterService>& services = parameter_services();
  services[bytes.byte() % services.size()].answer(scene.parameters, names, text_of(bytes.rest()));
}

/// Calls `receive` with each message of an input: one byte, odd for a binary message, two bytes of its length, its
/// bytes.
template <typename Receive>
void each_message(Input input, const Receive& receive) {
  while (input.size() >= 3) {
    const std::size_t size = std::min<std::size_t>(input[1] + 256u * input[2], input.size() - 3);
    receive(text_of(input.subspan(3, size)), input[0] % 2 == 1);
    input = input.subspan(3 + size);
  }
}

void drain(live::Peer& peer) {
  while (peer.next()) {
  }
}

void read_foxglove(Input input) {
  live::ControlQueue controls;
  live::FoxgloveHub hub(controls, "fuzz", live::PlaybackRange{0, 9'000'000'000});
  hub.set_parameters({{"ARM.angle", 1.5}, {"ARM.speed", 2}, {"GONE.x", 0, true}});
  hub.advertise({"/clock", &ros::describe<ros::Clock>(), ros::Durability::transient});
  live::FoxglovePeer peer(hub, 1);
  each_message(input, [&](std::string_view message, bool binary) {
    peer.receive(message, binary);
    hub.publish({"/clock", &ros::describe<ros::Clock>(), ros::Durability::transient}, 5, "abc");
    drain(peer);
  });
}

void read_page(Input input) {
  live::ControlQueue controls;
  live::ViewHub hub(controls, [](const live::ViewWants&) {});
  const std::unique_ptr<live::Peer> peer = hub.connect(1);
  each_message(input, [&](std::string_view message, bool binary) {
    peer->receive(message, binary);
    drain(*peer);
  });
}

/// A service with one page and one protocol, which repeats what it gets.
class EchoService : public live::Service {
 public:
  std::optional<live::Answer> get(std::string_view path, std::string_view) override {
    if (path != "/") return std::nullopt;
    live::Answer answer;
    answer.body = std::make_shared<const std::string>("page");
    return answer;
  }
  std::span<const std::string_view> protocols() const override { return kProtocols; }
  std::unique_ptr<live::Peer> connect(std::string_view) override { return std::make_unique<Echo>(); }

 private:
  static constexpr std::string_view kProtocols[] = {"echo"};
  class Echo : public live::Peer {
   public:
    void receive(std::string_view message, bool binary) override {
      if (message == "refuse") throw InputError("refused");
      last_ = live::WireMessage{.binary = binary, .head = std::string(message), .body = nullptr};
    }
    std::optional<live::WireMessage> next() override { return std::exchange(last_, {}); }

   private:
    std::optional<live::WireMessage> last_;
  };
};

constexpr std::string_view kUpgrade =
    "GET /?token=t HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: echo\r\n\r\n";

// A connection to the server: raw bytes after a first byte that is even, and after an odd one what follows a valid
// handshake of a WebSocket.
void read_http(Input input) {
  static EchoService service;
  static live::Server server({.token = "t"}, service);
  InputBytes bytes(input);
  const bool upgraded = bytes.byte() % 2 == 1;
  test::Socket socket(server.port());
  if (upgraded) socket.send(kUpgrade);
  socket.send(text_of(bytes.rest()));
  socket.finish_sending();
  socket.receive_all();
}

// What a client writes into its area of the shared memory, at the place that the first three bytes name.
void read_shared_memory(Input input) {
  static const std::string name = unique_name("fuzz");
  static std::unique_ptr<SharedHost> host;
  static int uses = 0;
  constexpr int kUses = 1000;  // each refusal adds to the log
  if (uses++ % kUses == 0) {
    host.reset();
    host = std::make_unique<SharedHost>(name);
    host->publish();
    add_pose(*host, "P");
  }
  if (input.size() < 3) return;
  const client::Connection connection(name, "fuzz");
  simvis_header header{};
  const int file = open_object(name);
  const std::size_t at = (input[0] + 256u * input[1] + 65536u * input[2]) % sizeof(simvis_client_area);
  const Input written = input.subspan(3, std::min(input.size() - 3, sizeof(simvis_client_area) - at));
  if (file < 0 || ::pread(file, &header, sizeof header, 0) != sizeof header) throw std::runtime_error("no host");
  const std::size_t area =
      header.clients_offset + static_cast<std::size_t>(simvis_slot_of(connection.get())) * sizeof(simvis_client_area);
  const bool whole = ::pwrite(file, written.data(), written.size(), static_cast<off_t>(area + at)) ==
                     static_cast<ssize_t>(written.size());
  ::close(file);
  if (!whole) throw std::runtime_error("the area cannot be written");
  host->take();
  host->is_ready("fuzz", 1);
}

const TargetRegistration kCdr("cdr", read_cdr);
const TargetRegistration kMeasurement("measurement", read_measurement);
const TargetRegistration kCommand("command", read_command);
const TargetRegistration kRequest("request", read_request);
const TargetRegistration kFoxglove("foxglove", read_foxglove);
const TargetRegistration kPage("page", read_page);
const TargetRegistration kHttp("http", read_http);
const TargetRegistration kSharedMemory("shared_memory", read_shared_memory);

}  // namespace
}  // namespace simvis::fuzz
