// How far --dds reaches: the variables of ROS 2, on one machine and on two.
#include <doctest/doctest.h>
#include <signal.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <simvis/error.h>
#include "exchange/messages/dds/discovery.h"
#include "tests/clients/shared_host.h"
#include "tests/support/error_of.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/two_machines.h"
#include "tests/support/wall_scene.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr const char* kVariables[] = {"ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS",
                                      "ROS_DOMAIN_ID"};

/// The variables of ROS 2 that are given, and no others.
class RosVariables {
 public:
  explicit RosVariables(const std::map<std::string, std::string>& given) {
    clear();
    for (const auto& [name, value] : given) ::setenv(name.c_str(), value.c_str(), 1);
  }
  ~RosVariables() { clear(); }
  RosVariables(const RosVariables&) = delete;
  RosVariables& operator=(const RosVariables&) = delete;

 private:
  static void clear() {
    for (const char* const name : kVariables) ::unsetenv(name);
  }
};

std::string config_of(const std::map<std::string, std::string>& given) {
  const RosVariables variables(given);
  return ros::cyclone_config(ros::discovery_of_environment());
}

constexpr const char* kLoopback = "<Interfaces><NetworkInterface address='127.0.0.1'/>";

/// The bytes of UDP that the first machine sends to the second, by domain, in so many seconds.
constexpr const char* kCapture = R"py(
import socket, sys, time
every_protocol, ip = 3, 0x0800  # only those that take every protocol get what is sent
packets = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(every_protocol))
packets.bind(("east", every_protocol))
packets.settimeout(0.1)
print("ready", flush=True)
sent, end = {}, time.monotonic() + float(sys.argv[1])
while time.monotonic() < end:
    try:
        packet, sender = packets.recvfrom(65536)
    except TimeoutError:
        continue
    if sender[1] != ip or sender[2] != socket.PACKET_OUTGOING or packet[9] != socket.IPPROTO_UDP:
        continue
    start = (packet[0] & 15) * 4
    port = int.from_bytes(packet[start + 2:start + 4], "big")
    domain = (port - 7400) // 250
    sent[domain] = sent.get(domain, 0) + len(packet)
print(*(f"{domain} {bytes}" for domain, bytes in sent.items()))
)py";

/// Says whether the first machine takes packets at the ports of the first participants of a domain: it answers those
/// that no socket takes.
constexpr const char* kKnock = R"py(
import socket, sys
def is_taken(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as knocking:
        knocking.settimeout(0.5)
        knocking.connect(("10.123.0.1", port))
        try:
            for _ in range(4):
                knocking.send(b"RTPS")
                knocking.recv(1)
        except ConnectionRefusedError:
            return False
        except TimeoutError:
            return True
first = 7400 + 250 * int(sys.argv[1]) + 10
print("taken" if any([is_taken(first + 2 * i) for i in range(3)]) else "refused")
)py";

}  // namespace

TEST_CASE("the variables of ROS 2 become settings of Cyclone") {
  CHECK(config_of({}) == "");
  CHECK(config_of({{"ROS_LOCALHOST_ONLY", "0"}}) == "");
  CHECK(config_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"}}) == "");
  CHECK(config_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}, {"ROS_STATIC_PEERS", "a"}}) == "");
  const std::string local = config_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}});
  CHECK(contains(local, kLoopback));
  CHECK(contains(local, "<AllowMulticast>false</AllowMulticast>"));
  CHECK(contains(local, "<Peers><Peer address='127.0.0.1'/></Peers>"));
  // The older variable goes before the others, as in ROS 2.
  CHECK(config_of({{"ROS_LOCALHOST_ONLY", "1"},
                   {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"},
                   {"ROS_STATIC_PEERS", "10.0.0.1"}}) == local);
  const std::string off = config_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}, {"ROS_STATIC_PEERS", "10.0.0.1"}});
  CHECK(contains(off, kLoopback));
  CHECK(contains(off, "<Tag>simvis_off_"));
  CHECK(off.find("<Peer ") == off.npos);
  const std::string both =
      config_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}, {"ROS_STATIC_PEERS", "10.0.0.1;;robot.local"}});
  CHECK(contains(both, "<Peer address='127.0.0.1'/><Peer address='10.0.0.1'/><Peer address='robot.local'/>"));
  CHECK(both.find("Interfaces") == both.npos);
  const std::string peers = config_of({{"ROS_STATIC_PEERS", "10.0.0.1"}});
  CHECK(contains(peers, "<Peers><Peer address='10.0.0.1'/></Peers>"));
  CHECK(peers.find("AllowMulticast") == peers.npos);

  CHECK(contains(error_of([] {
                   config_of({{"ROS_LOCALHOST_ONLY", "true"}});
                 }),
                 "ROS_LOCALHOST_ONLY is \"true\", expected 0 or 1"));
  CHECK(contains(error_of([] {
                   config_of({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost"}});
                 }),
                 "is \"localhost\", expected SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT"));
  CHECK(contains(error_of([] {
                   config_of({{"ROS_STATIC_PEERS", "a'/><Tag>"}});
                 }),
                 "expected host names and addresses"));
  for (const char* const wrong : {"233", "-1", "7a", " 7"}) {
    CHECK(contains(error_of([&] { config_of({{"ROS_DOMAIN_ID", wrong}}); }), "expected a whole number from 0 to 232"));
  }
}

TEST_CASE("DDS: a domain without a number is that of ROS_DOMAIN_ID, and a number goes before it") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain(), other = own_domain();
  const RosVariables variables(std::map<std::string, std::string>{{"ROS_DOMAIN_ID", std::to_string(domain)}});
  CHECK(ros::DdsNode(std::nullopt).reach().domain == domain);
  const ros::DdsReach reach = ros::DdsNode(other).reach();
  CHECK(reach.domain == other);
  CHECK(reach.is_local);
  CHECK(reach.interfaces == std::vector<std::string>{"lo"});
}

TEST_CASE("DDS: two nodes of one process share a domain that the variables of ROS 2 configure") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain();
  const RosVariables variables(std::map<std::string, std::string>{{"ROS_LOCALHOST_ONLY", "1"}});
  for (int time = 0; time < 2; ++time) {
    const ros::DdsNode one(domain), two(domain);
    CHECK(one.reach().domain == domain);
    CHECK(two.reach().is_local);
  }
}

TEST_CASE("DDS: the program says at its start who may do what") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), "").string(), domain = std::to_string(own_domain());
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command{tested_build() + "/bin/simvis-run", "--dds", domain, "--frames", "1", "--out",
                                     (folder / "out").string(),          scene};
    command.insert(command.end(), more.begin(), more.end());
    return Process(command).wait().out;
  };
  const std::string who = "DDS: domain " + domain + " on this machine alone; its programs may set parameters and " +
                          "command robots, change requests are ";
  CHECK(contains(said({}), who + "refused without --dds-requests\n"));
  CHECK(contains(said({"--dds-requests"}), who + "executed\n"));
}

TEST_CASE("DDS: with the variables of ROS 2 that say so, nothing leaves this machine and nothing of others comes in") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const TemporaryFolder folder;
  const TwoMachines machines(folder.path());
  if (!machines.exist()) return test::skip(machines.why_not());
  struct Host {
    std::string variable;
    bool is_local, has_first_port;
  };
  const Host hosts[] = {{"ROS_LOCALHOST_ONLY=1", true, true},
                        {"ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST", true, true},
                        {"ROS_AUTOMATIC_DISCOVERY_RANGE=OFF", true, false},
                        {"ROS_STATIC_PEERS=10.123.0.2", false, true},
                        {"ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET", false, false}};
  const std::string scene = write_wall_scene(folder.path(), "").string(), program = tested_build() + "/bin/simvis-run";
  const auto name_of = [](std::size_t domain) { return unique_name("range" + std::to_string(domain)); };
  Process capture(machines.on_first({"/usr/bin/python3", "-c", kCapture, "12"}));
  std::vector<std::unique_ptr<Process>> running;
  for (std::size_t domain = 0; domain < std::size(hosts); ++domain) {
    running.push_back(std::make_unique<Process>(
        machines.on_first({program, "--serve", name_of(domain), "--dds", std::to_string(domain), "--quiet",
                           "--real-time", "1", "--out", (folder / name_of(domain)).string(), scene}),
        std::vector<std::string>{"CYCLONEDDS_URI=", hosts[domain].variable}));
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  for (std::size_t domain = 0; domain < std::size(hosts); ++domain) {
    const std::vector<std::string> list{tested_build() + "/bin/simvis-ctl", name_of(domain), "list"};
    while (Process(machines.on_first(list)).wait().exit_code != 0) REQUIRE(std::chrono::steady_clock::now() < end);
  }
  // Followers of the same machine find the host: with the same variable, and with the setting that rmw_cyclonedds has
  // for it in Humble.
  const std::string settings[] = {
      "ROS_LOCALHOST_ONLY=1",
      "CYCLONEDDS_URI=<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces>"
      "</General></Domain></CycloneDDS>"};
  for (const std::string& setting : settings) {
    CAPTURE(setting);
    std::vector<std::string> environment{setting};
    if (!setting.starts_with("CYCLONEDDS_URI")) environment.emplace_back("CYCLONEDDS_URI=");
    const ProcessResult follower = Process(machines.on_first({program, "--follow", "dds:0/" + name_of(0), "--quiet",
                                                              "--frames", "1", "--out", (folder / "seen").string()}),
                                           environment)
                                       .wait(std::chrono::seconds(30));
    CHECK_MESSAGE(follower.exit_code == 0, follower.err);
  }
  for (std::size_t domain = 0; domain < std::size(hosts); ++domain) {
    if (!hosts[domain].has_first_port) continue;
    CAPTURE(hosts[domain].variable);
    const ProcessResult knock =
        Process(machines.on_second({"/usr/bin/python3", "-c", kKnock, std::to_string(domain)})).wait();
    CHECK(knock.out == (hosts[domain].is_local ? "refused\n" : "taken\n"));
  }
  const ProcessResult captured = capture.wait();
  std::map<std::size_t, std::size_t> bytes;
  std::istringstream all(captured.out.substr(captured.out.find('\n')));
  for (std::size_t domain = 0, count = 0; all >> domain >> count;) bytes[domain] = count;
  for (std::size_t domain = 0; domain < std::size(hosts); ++domain) {
    CAPTURE(hosts[domain].variable);
    CHECK((bytes[domain] == 0) == hosts[domain].is_local);
  }
  for (const std::unique_ptr<Process>& each : running) each->send(SIGINT);
  for (const std::unique_ptr<Process>& each : running) CHECK(each->wait().exit_code == 130);
}

TEST_SUITE_END();
