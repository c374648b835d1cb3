// simvis-run --compare: recordings of both kinds against their own scene, the files that it writes, and what it
// refuses.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "exchange/packets/pcap.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("fidelity");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// A room around a tilted sensor, so that each ring meets walls at many angles.
std::string room_scene(const std::string& sensors) {
  return R"(<simvis>
  <part shape="box" size="9 7 5" name="ROOM" insert_at="ROOT"/>
  <element type="material" name="PAINT" insert_at="ROOT" part="ROOM" red="0.5" green="0.5" blue="0.5"/>
)" + sensors +
         "</simvis>\n";
}

std::string scanner(const std::string& attributes, const std::string& name = "LIDAR") {
  return R"(<sensor type="laser_scanner" name=")" + name +
         R"(" insert_at="ROOT" pose_offset="0.5 -0.4 0.2 25 20 10" intensity="on" )" + attributes + "/>\n";
}

constexpr const char* kVlp16 = R"(preset="velodyne_vlp16")";

bool is_within(const Json& parameters, const std::string& name, double truth) {
  const Json& fitted = parameters.at(name).at("fitted");
  MESSAGE(name << ": " << fitted.dump());
  // Three times the half width: of these few numbers none is that far off but once in 10^8 times.
  const double middle = fitted.at("value"),
               half = std::max(fitted.at("high").get<double>() - middle, middle - fitted.at("low").get<double>());
  return std::abs(middle - truth) <= 3 * half;
}

struct Compared {
  ProcessResult result;
  Json json;
};

Compared compare(const TemporaryFolder& folder, const std::string& recording, const Strings& more) {
  Strings arguments = {(folder / "scene.xml").string(), "--compare", (folder / recording).string(), "--out",
                       (folder / "report").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Compared compared{run_simvis(arguments), {}};
  INFO(compared.result.err);
  REQUIRE(compared.result.exit_code == 0);
  compared.json = Json::parse(read_text(folder / "report/fidelity.json"));
  return compared;
}

void record(const TemporaryFolder& folder, const std::string& scene, const Strings& options) {
  write_text(folder / "device.xml", scene);
  Strings arguments = {(folder / "device.xml").string(), "--rate", "10", "--frames", "3", "--quiet", "--out",
                       (folder / "out").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProcessResult result = run_simvis(arguments);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
}

// The message of a comparison that is refused with status 2, and leaves nothing.
std::string refusal(const TemporaryFolder& folder, const Strings& options) {
  Strings arguments = {(folder / "scene.xml").string(), "--out", (folder / "report").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProcessResult result = run_simvis(arguments);
  CHECK(result.exit_code == 2);
  CHECK(result.out.empty());
  CHECK_FALSE(fs::exists(folder / "report"));
  return result.err;
}

}  // namespace

TEST_CASE("--compare fits a capture of a VLP-16 to the scene, and says so as text, JSON and a picture") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml", room_scene(scanner(kVlp16)));
  record(folder, room_scene(scanner(R"(preset="velodyne_vlp16" range_bias="0" range_noise="0.02" dropout="0.05")")),
         {"--record-pcap", (folder / "lidar.pcap").string()});
  const Compared compared = compare(folder, "lidar.pcap", {"--frames", "2"});
  const Json& json = compared.json;
  CHECK(json.at("scans") == 2);
  CHECK(json.at("beams").at("all") == 2 * 16 * 1800);
  std::size_t sum = 0;
  for (const auto& [name, count] : json.at("beams").items()) sum += name == "all" ? 0 : count.get<std::size_t>();
  CHECK(sum == 2 * 16 * 1800);
  CHECK(json.at("rings").size() == 16);
  const Json& parameters = json.at("parameters");
  CHECK(is_within(parameters, "range_bias", 0));
  CHECK(is_within(parameters, "range_noise", 0.02));
  CHECK(is_within(parameters, "intensity_gain", 100));
  CHECK(is_within(parameters, "intensity_angle", 1));
  CHECK(is_within(parameters, "dropout", 0.05));
  CHECK(parameters.at("dropout_power").at("fitted").is_null());
  CHECK(contains(compared.result.out, "LIDAR against Velodyne VLP-16: 2 scans, 57600 beams\n"));
  CHECK(contains(compared.result.out, "range_noise"));
  CHECK(contains(compared.result.out, "95 % interval"));
  const std::string svg = read_text(folder / "report/fidelity.svg");
  CHECK(svg.starts_with("<svg"));
  CHECK(svg.ends_with("</svg>\n"));
  CHECK(files_below(folder / "report") == Strings{"fidelity.json", "fidelity.svg"});
}

TEST_CASE("--compare reads clouds and planar scans of MCAP files, and the chosen topic") {
  const TemporaryFolder folder;
  const std::string grid =
      R"(samples="180" min_angle="-180" max_angle="178" vertical_samples="8" vertical_min_angle="-20" vertical_max_angle="20")";
  const std::string planar = R"(samples="720" min_angle="-180" max_angle="179.5")";
  write_text(folder / "scene.xml", room_scene(scanner(grid) + scanner(planar, "PLANAR")));
  record(folder,
         room_scene(scanner(grid + R"( range_noise="0.01" dropout="0.1")") +
                    scanner(planar + R"( range_noise="0.03")", "PLANAR")),
         {"--record", (folder / "scans.mcap").string()});
  CHECK(contains(refusal(folder, {"--compare", (folder / "scans.mcap").string(), "--sensor", "LIDAR"}),
                 "has several topics with scans, expected --compare-topic with one of: "));
  const Compared cloud = compare(folder, "scans.mcap", {"--sensor", "LIDAR", "--compare-topic", "/LIDAR/points"});
  CHECK(cloud.json.at("scans") == 3);
  CHECK(is_within(cloud.json.at("parameters"), "range_noise", 0.01));
  CHECK(is_within(cloud.json.at("parameters"), "dropout", 0.1));
  CHECK(is_within(cloud.json.at("parameters"), "intensity_range", 2));
  const Compared scan = compare(folder, "scans.mcap", {"--sensor", "PLANAR", "--compare-topic", "/PLANAR/scan"});
  CHECK(is_within(scan.json.at("parameters"), "range_noise", 0.03));
  CHECK(scan.json.at("rings").size() == 1);
}

TEST_CASE("--compare leaves out what the scanner ignores, such as its housing") {
  const TemporaryFolder folder;
  record(folder, room_scene(scanner(kVlp16)), {"--record-pcap", (folder / "device.pcap").string()});
  write_text(folder / "scene.xml", room_scene(scanner(kVlp16)));
  const Json bare = compare(folder, "device.pcap", {}).json;
  const std::string housing =
      R"(<part shape="sphere" radius="0.05" name="HOUSING" insert_at="ROOT" pose_offset="0.5 -0.4 0.2 0 0 0"/>)";
  write_text(folder / "scene.xml", room_scene(housing + scanner(std::string(kVlp16) + " ignore='HOUSING'")));
  CHECK(compare(folder, "device.pcap", {}).json.at("parameters") == bare.at("parameters"));
}

TEST_CASE("--fit-pose finds where the sensor really stood") {
  const TemporaryFolder folder;
  std::string moved = scanner(R"(preset="velodyne_vlp16" range_bias="0" range_noise="0.01")");
  const std::string place = "0.5 -0.4 0.2";
  moved.replace(moved.find(place), place.size(), "0.53 -0.4 0.2");
  write_text(folder / "scene.xml", room_scene(scanner(kVlp16)));
  record(folder, room_scene(moved), {"--record-pcap", (folder / "lidar.pcap").string()});
  const Json parameters = compare(folder, "lidar.pcap", {"--fit-pose"}).json.at("parameters");
  // 3 cm along x of the world, in the frame of the sensor: the first column of the transposed rotation by roll, pitch,
  // yaw of 25, 20 and 10 degrees.
  CHECK(is_within(parameters, "position_x", 0.03 * 0.925417));
  CHECK(is_within(parameters, "position_y", 0.03 * -0.015031));
  CHECK(is_within(parameters, "position_z", 0.03 * 0.378653));
  CHECK(is_within(parameters, "range_bias", 0));
  CHECK(is_within(parameters, "range_noise", 0.01));
}

TEST_CASE("what cannot be compared is refused with the reason") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml", room_scene(scanner(R"(preset="velodyne_hdl32e")")));
  record(folder, room_scene(scanner(kVlp16)), {"--record-pcap", (folder / "lidar.pcap").string()});
  const std::string pcap = (folder / "lidar.pcap").string();
  CHECK(contains(refusal(folder, {"--compare", pcap}),
                 "--compare: " + pcap + ": error: holds packets of a VLP-16, expected those of a Velodyne HDL-32E"));
  write_text(folder / "scene.xml", room_scene(scanner(R"(preset="ouster_os1_32")")));
  CHECK(contains(refusal(folder, {"--compare", pcap}),
                 "other datagrams, the first of 1206 bytes to port 2368, expected data packets of 6400 bytes"));
  write_text(folder / "empty.pcap", pcap_header());
  CHECK(contains(refusal(folder, {"--compare", (folder / "empty.pcap").string()}),
                 "holds no datagrams, expected data packets"));
  write_text(folder / "scene.xml", room_scene(scanner(R"(samples="5")")));
  CHECK(contains(refusal(folder, {"--compare", pcap}),
                 R"(sensor "LIDAR" does not have the beams of a device whose packets are known)"));
  CHECK(contains(refusal(folder, {"--compare", "lidar.bag"}),
                 R"(--compare: "lidar.bag" has another extension, expected a file .pcap or .mcap)"));
  CHECK(contains(refusal(folder, {"--compare", pcap, "--compare-topic", "/a"}), "a capture file has no topics"));
  CHECK(contains(refusal(folder, {"--compare-topic", "/a"}), "--compare-topic requires --compare"));
  write_text(folder / "scene.xml", room_scene(""));
  CHECK(contains(refusal(folder, {"--compare", pcap}), "--compare: the scene has no enabled laser scanner"));
  write_text(folder / "scene.xml", room_scene(scanner(kVlp16) + scanner(kVlp16, "OTHER")));
  CHECK(contains(refusal(folder, {"--compare", pcap}),
                 "several laser scanners, expected --sensor with one of: LIDAR, OTHER"));
  write_text(folder / "scene.xml", room_scene(scanner(kVlp16)));
  CHECK(contains(refusal(folder, {"--compare", (folder / "none.pcap").string()}), "none.pcap"));
  for (const char* const pipe : {"pipe.pcap", "pipe.mcap"}) {
    REQUIRE(::mkfifo((folder / pipe).c_str(), 0600) == 0);
    CHECK(contains(refusal(folder, {"--compare", (folder / pipe).string()}), "is not a regular file"));
  }
  // A folder that cannot be made is found before the recording is read.
  const ProcessResult no_folder =
      run_simvis({(folder / "scene.xml").string(), "--compare", (folder / "none.pcap").string(), "--out",
                  (folder / "lidar.pcap" / "report").string()});
  CHECK(no_folder.exit_code == 1);
  CHECK(contains(no_folder.err, "lidar.pcap/report"));
  CHECK_FALSE(contains(no_folder.err, "none.pcap"));
  // Nothing of the recording is where the scene has something.
  write_text(
      folder / "scene.xml",
      "<simvis>\n<part shape=\"box\" size=\"1 1 1\" name=\"BOX\" insert_at=\"ROOT\" pose_offset=\"500 0 0 0 0 0\"/>\n" +
          scanner(kVlp16) + "</simvis>\n");
  CHECK(contains(refusal(folder, {"--compare", pcap}), "no beam of the recording reads a surface of the scene"));
}

}  // namespace simvis

TEST_SUITE_END();
