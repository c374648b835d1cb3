// The folder of a dataset: the same bytes from shards, killed processes and any number of threads, and one message for
// each input that cannot become a dataset.
#include "program/datasets/dataset_folder.h"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/datasets/dataset_scene.h"
#include "tests/support/long_count.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("datasets");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using FileBytes = std::map<std::string, std::string>;

// With the sanitizers, which make everything ten times slower, one with cameras and a scanner.
const std::vector<std::string> kFormats =
    sanitized()
        ? std::vector<std::string>{"nuscenes"}
        : std::vector<std::string>{"bop", "coco", "colmap", "euroc", "kitti", "nuscenes", "semantickitti", "tum"};
// Event cameras follow every frame, so that no process can leave frames out.
const std::vector<std::string> kAllFormats = [] {
  std::vector<std::string> all = kFormats;
  if (!sanitized()) all.emplace_back("dsec");
  return all;
}();
const std::set<std::string> kScanned{"kitti", "nuscenes", "semantickitti"};  // formats with a scanner

/// A folder with the scene and a dataset of it, made by one process.
class MadeDataset {
 public:
  explicit MadeDataset(const std::string& format) : format_(format) {
    write_text(folder_ / "scene.xml",
               dataset_scene("color depth instance boxes silhouettes", kScanned.contains(format) ? kDatasetScanner
                                                                       : format == "euroc"       ? kDatasetImu
                                                                       : format == "dsec"        ? kDatasetEvents
                                                                                                 : std::string()));
    make("whole", {});
    whole_ = bytes_below(folder_ / "whole");
    REQUIRE(whole_.size() > 10);
    REQUIRE(whole_.contains("contact_sheet.png"));
  }

  void make(const std::string& out, Strings more) const {
    more.insert(more.end(), {"--dataset", format_});
    make_dataset(scene(), folder_ / out, more);
  }
  fs::path scene() const { return folder_ / "scene.xml"; }
  fs::path operator/(const std::string& name) const { return folder_ / name; }
  const FileBytes& whole() const { return whole_; }

 private:
  TemporaryFolder folder_;
  std::string format_;
  FileBytes whole_;
};

/// Checks that simvis-run refuses with exit code 2 and a message with this text.
void check_no_dataset(const fs::path& scene, Strings arguments, const std::string& expected) {
  CAPTURE(expected);
  arguments.insert(arguments.begin(), scene.string());
  const ProcessResult result = run_simvis(arguments);
  CHECK(result.exit_code == 2);
  CHECK_MESSAGE(result.err.find(expected) != std::string::npos, result.err);
  CHECK(std::ranges::count(result.err, '\n') == 1);
}

TEST_CASE("shards in any order, and any number of threads, make the same bytes as one process") {
  for (const std::string& format : kFormats) {
    CAPTURE(format);
    const MadeDataset made(format);
    for (const char* const shard : {"2/3", "0/3", "1/3"}) {
      CHECK_FALSE(fs::exists(made / "shards/contact_sheet.png"));
      made.make("shards", {"--shard", shard});
    }
    CHECK(bytes_below(made / "shards") == made.whole());
    made.make("one_thread", {"--threads", "1"});
    CHECK(bytes_below(made / "one_thread") == made.whole());
  }
}

TEST_CASE("shards that run at the same time make the same bytes, and one of them the files of the whole") {
  const MadeDataset made("coco");
  std::vector<std::unique_ptr<Process>> shards;
  for (const char* const shard : {"0/2", "1/2"}) {
    shards.push_back(
        std::make_unique<Process>(Strings{simvis_run(), made.scene().string(), "--frames", "4", "--quiet", "--dataset",
                                          "coco", "--out", (made / "both").string(), "--shard", shard}));
  }
  for (const std::unique_ptr<Process>& each : shards) {
    const ProcessResult result = each->wait();
    CHECK_MESSAGE(result.exit_code == 0, result.err);
  }
  CHECK(bytes_below(made / "both") == made.whole());
}

// A process that is killed between the two leaves files without a record, which are made again, and never a record
// without files. The kills below meet that moment too rarely.
TEST_CASE("the record of a frame is written after all files of the frame") {
  const MadeDataset made("bop");
  int compared = 0;
  for (const auto& [name, bytes] : made.whole()) {
    for (int frame = 0; frame < 4; ++frame) {
      const std::string number = "00000" + std::to_string(frame), stem = fs::path(name).stem().string();
      const bool is_of_frame = name.starts_with("train/") && (stem == number || stem.starts_with(number + "_"));
      if (!is_of_frame) continue;
      CAPTURE(name);
      CHECK(fs::last_write_time(made / ("whole/.simvis/frames/" + number + ".json")) >=
            fs::last_write_time(made / ("whole/" + name)));
      ++compared;
    }
  }
  CHECK(compared > 40);
}

TEST_CASE("records that somebody has edited are one message") {
  const MadeDataset made("nuscenes");
  const fs::path record = made / "whole/.simvis/frames/000002.json";
  const std::string own = read_text(record);
  std::string other_sensor = own;
  other_sensor.insert(other_sensor.find("\"CAM\":"), "\"OTHER\":{\"pose\":[]},");
  std::string drawn = own;
  drawn.replace(drawn.find("\"drawn\":\""), 9, "\"drawn\":5,\"was\":\"");
  for (const std::string& edited : {std::string("[]"), std::string("{}"), other_sensor, drawn}) {
    CAPTURE(edited);
    write_text(record, edited);
    check_no_dataset(
        made.scene(),
        {"--quiet", "--frames", "4", "--dataset", "nuscenes", "--resume", "--out", (made / "whole").string()},
        "a record is not as simvis-run wrote it, expected another --out");
  }
}

TEST_CASE("a dataset whose process is killed anywhere is the same after --resume") {
  const int kills = count_of("SIMVIS_TEST_KILLS", static_cast<int>(kAllFormats.size()));
  int unfinished = 0;
  for (int kill = 0; kill < kills; ++kill) {
    const std::string format = kAllFormats[static_cast<std::size_t>(kill) % kAllFormats.size()];
    CAPTURE(format);
    const MadeDataset made(format);
    const Strings command = {simvis_run(), made.scene().string(),      "--frames", "4", "--quiet", "--dataset", format,
                             "--out",      (made / "killed").string(), "--resume"};
    // From before the folder is there until after the last file, at different points of each round.
    for (int round = 0; round < 3; ++round) {
      Process running(command);
      const auto begin = std::chrono::steady_clock::now();
      while (!fs::exists(made / "killed/.simvis/dataset.json") &&
             std::chrono::steady_clock::now() - begin < std::chrono::seconds(60)) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(7 * kill * (round + 1)));
      running.send(SIGKILL);
      running.wait();
      unfinished += fs::exists(made / "killed/contact_sheet.png") ? 0 : 1;
      // Whatever has a name is whole.
      for (const auto& [name, bytes] : bytes_below(made / "killed")) {
        const bool is_hidden = fs::path(name).filename().string().starts_with(".");
        if (!is_hidden && made.whole().contains(name)) CHECK_MESSAGE(bytes == made.whole().at(name), name);
      }
    }
    const ProcessResult last = Process(command).wait();
    CHECK_MESSAGE(last.exit_code == 0, last.err);
    CHECK(bytes_below(made / "killed") == made.whole());
  }
  CHECK(unfinished > 0);
}

TEST_CASE("drawn values are in a file, and are those of the seed and the frame") {
  const MadeDataset made("tum");
  const Table drawn = read_csv(made / "whole/randomized.csv");
  CHECK(drawn.columns == Strings{"frame", "element", "parameter", "value"});
  REQUIRE(drawn.rows.size() == 8);
  CHECK(drawn.rows[2][0] == "1");
  CHECK(drawn.rows[2][1] == "PUSH");
  CHECK(drawn.rows[2][3] != drawn.rows[0][3]);
  make_dataset(made.scene(), made / "plain", {});
  CHECK(read_text(made / "plain/randomized.csv") == made.whole().at("randomized.csv"));
  make_dataset(made.scene(), made / "other_seed", {"--seed", "5"});
  CHECK(read_text(made / "other_seed/randomized.csv") != made.whole().at("randomized.csv"));
}

TEST_CASE("a folder of something else is refused and left as it is") {
  const MadeDataset made("tum");
  const std::string whole = (made / "whole").string();
  const auto refused = [&](const Strings& more, const std::string& expected) {
    Strings arguments = {"--frames", "4", "--out", whole};
    arguments.insert(arguments.end(), more.begin(), more.end());
    check_no_dataset(made.scene(), arguments, expected);
    CHECK(bytes_below(made / "whole") == made.whole());
  };
  refused({"--dataset", "tum"}, "holds this dataset already, expected --resume");
  refused({"--dataset", "coco", "--resume"},
          "holds another dataset: its \"format\" is \"tum\", and this one has \"coco\"");
  refused({"--dataset", "tum", "--seed", "9", "--resume"}, "holds another dataset: its \"seed\"");
  refused({"--dataset", "tum", "--shard", "0/2", "--seed", "9"}, "holds another dataset: its \"seed\"");
  fs::create_directories(made / "other");
  write_text(made / "other/notes.txt", "mine");
  check_no_dataset(made.scene(), {"--dataset", "tum", "--out", (made / "other").string()},
                   "holds other files, such as \"notes.txt\", expected an empty or a new folder");
  CHECK(files_below(made / "other") == Strings{"notes.txt"});
}

TEST_CASE("a FIFO in the place of a dataset's own file is refused, and not waited for") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml", dataset_scene());
  fs::create_directories(folder / "out/.simvis");
  REQUIRE(::mkfifo((folder / "out/.simvis/dataset.json").c_str(), 0600) == 0);
  check_no_dataset(folder / "scene.xml", {"--quiet", "--dataset", "tum", "--out", (folder / "out").string()},
                   "dataset.json: error: cannot be read");
}

TEST_CASE("formats, sensors and outputs that do not fit have one message each") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& scene, const Strings& arguments, const std::string& expected) {
    write_text(folder / "scene.xml", scene);
    Strings all = {"--out", (folder / "out").string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    check_no_dataset(folder / "scene.xml", all, expected);
    CHECK_FALSE(fs::exists(folder / "out"));
  };
  refused(dataset_scene(), {"--dataset", "cocoo"}, "there is no format \"cocoo\", did you mean \"coco\"?");
  refused(dataset_scene(), {"--dataset", "tum,cocoo"}, "there is no format \"cocoo\", did you mean \"coco\"?");
  refused(dataset_scene("color depth"), {"--dataset", "tum,bop"}, "lacks outputs");
  refused(dataset_scene("color depth"), {"--dataset", "bop"},
          "camera \"CAM\" lacks outputs, expected at least outputs=\"color depth instance boxes silhouettes\"");
  refused(dataset_scene("color", kDatasetScanner), {"--dataset", "tum"}, "lacks outputs");
  refused(dataset_scene("color depth instance boxes silhouettes", kDatasetScanner), {"--dataset", "coco"},
          "the format cannot hold the sensor \"SCAN\", expected cameras and their keypoints");
  refused(dataset_scene("color depth instance boxes silhouettes\" distortion=\"brown_conrady\" k1=\"-0.1"),
          {"--dataset", "bop"}, "camera \"CAM\" has a lens, which the format cannot describe");
  for (const char* const lens :
       {"double_sphere\" alpha=\"0.6", "ftheta\" polynomial=\"0 60", "rational_polynomial\" s1=\"0.01"}) {
    std::string scene = dataset_scene(std::string("color depth\" distortion=\"") + lens);
    constexpr std::string_view kAngle = " hfov=\"70\"";
    if (std::string_view(lens).starts_with("ftheta"))
      scene.erase(scene.find(kAngle), kAngle.size());  // the lens has one
    refused(scene, {"--dataset", "colmap"},
            "camera \"CAM\" has a lens that the format cannot describe, expected distortion=\"none\", brown_conrady, "
            "kannala_brandt, or rational_polynomial without thin prism and tilt");
  }
  refused(dataset_scene("color depth", kDatasetScanner), {"--dataset", "colmap"},
          "the format cannot hold the sensor \"SCAN\", expected cameras");
  const std::string twins =
      "<sensor type='stereo_camera' name='EYES' insert_at='CAR' width='96' height='72' outputs='color depth instance "
      "boxes silhouettes'/><sensor type='camera' name='EYES_left' insert_at='CAR' width='64' height='48' "
      "outputs='color depth instance boxes silhouettes'/>";
  for (const char* const format : {"coco", "bop"}) {
    refused(dataset_scene("color depth instance boxes silhouettes", twins), {"--dataset", format},
            "two views have the name \"EYES_left\"");
  }
  for (const char* const format : {"bop", "coco", "colmap", "euroc", "tum"}) {
    refused("<simvis/>", {"--dataset", format}, "the scene has no camera that is on, expected at least one");
  }
  refused(
      "<simvis><part name='P' insert_at='ROOT'/><sensor type='keypoints' name='KEYS' insert_at='ROOT' points='P'/>"
      "</simvis>",
      {"--dataset", "coco"}, "the scene has no camera that is on");
  refused(dataset_scene(), {"--dataset", "semantickitti"}, "expected one or two views and a laser scanner");
  refused(dataset_scene(), {"--dataset", "tum", "--format", "depth=npy"}, "--dataset excludes --format");
}

TEST_CASE("sensors that EuRoC and nuScenes cannot hold have one message each") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& scene, const std::string& format, const Strings& more,
                           const std::string& expected) {
    write_text(folder / "scene.xml", scene);
    Strings all = {"--quiet", "--dataset", format, "--out", (folder / "out").string()};
    all.insert(all.end(), more.begin(), more.end());
    check_no_dataset(folder / "scene.xml", all, expected);
    fs::remove_all(folder / "out");
  };
  const std::string other_imu = "<sensor type='imu' name='IMU2' insert_at='CAR'/>",
                    elsewhere = "<sensor type='imu' name='IMU' insert_at='ROOT'/>";
  std::string blind = kDatasetScanner;
  blind.replace(blind.find("instance semantic"), 17, "range");
  refused(dataset_scene("color", kDatasetScanner), "euroc", {},
          "cannot hold the sensor \"SCAN\", expected cameras and one imu");
  refused(dataset_scene("color", kDatasetImu + other_imu), "euroc", {}, "cannot hold the sensor \"IMU2\"");
  refused(dataset_scene("color\" distortion=\"brown_conrady\" k3=\"0.01", kDatasetImu), "euroc", {},
          "camera \"CAM\" has a lens that the format cannot describe");
  refused(dataset_scene("color", elsewhere), "euroc", {"--frames", "3"},
          "in frame 1 \"CAM\" is elsewhere relative to \"IMU\" than before");
  refused(
      dataset_scene("color",
                    "<sensor type='stereo_camera' name='EYES' insert_at='CAR' width='32' height='24' outputs='color'/>"
                    "<sensor type='imu' name='EYES_left' insert_at='CAR'/>"),
      "euroc", {}, "a view and the imu have the name \"EYES_left\"");
  refused("<simvis><part name='CAR' insert_at='ROOT'/>" + kDatasetImu + "</simvis>", "euroc", {},
          "the scene has no camera that is on");
  refused(dataset_scene("color", blind), "nuscenes", {},
          "scanner \"SCAN\" does not say which objects its points are on, expected truth=\"instance\"");
  refused(dataset_scene("color\" distortion=\"brown_conrady\" k1=\"-0.1", kDatasetScanner), "nuscenes", {},
          "camera \"CAM\" has a lens");
  refused(dataset_scene("color", kDatasetImu), "nuscenes", {}, "cannot hold the sensor \"IMU\"");
  refused("<simvis/>", "nuscenes", {}, "the scene has no camera or scanner that is on");
}

TEST_CASE("frames in which some sensors measure are sweeps of nuScenes, and EuRoC has sensors with own rates") {
  const TemporaryFolder folder;
  const auto made = [&](const std::string& format, const std::string& sensor) {
    std::string scene = dataset_scene("color instance boxes", sensor);
    scene.insert(scene.find(" width=\"96\""), " rate=\"10\"");
    write_text(folder / "scene.xml", scene);
    make_dataset(folder / "scene.xml", folder / format, {"--dataset", format, "--rate", "20"});
    const Strings files = files_below(folder / format);
    return std::set<std::string>(files.begin(), files.end());
  };
  const std::set<std::string> nuscenes = made("nuscenes", kDatasetScanner);
  for (const char* const file :
       {"samples/CAM/000000.png", "samples/SCAN/000002.bin", "sweeps/SCAN/000001.bin", "sweeps/SCAN/000003.bin"}) {
    CHECK(nuscenes.contains(file));
  }
  CHECK_FALSE(nuscenes.contains("sweeps/CAM/000001.png"));
  const std::set<std::string> euroc = made("euroc", kDatasetImu);
  CHECK(euroc.contains("mav0/cam0/data/100000000.png"));
  CHECK_FALSE(euroc.contains("mav0/cam0/data/50000000.png"));
  CHECK(read_text(folder / "euroc/mav0/cam0/sensor.yaml").find("rate_hz: 10\n") != std::string::npos);
  CHECK(read_text(folder / "euroc/mav0/imu0/sensor.yaml").find("rate_hz: 20\n") != std::string::npos);
}

// A class is one of nuScenes, or the devkit has no color for it.
TEST_CASE("each class that nuscenes-devkit cannot draw is one warning") {
  struct ClassCase {
    std::string format, chair, table, ball;
    Strings unknown;
  };
  const std::vector<ClassCase> cases = {{"nuscenes", "chair", "table", "ball", {"ball", "chair", "table"}},
                                        {"nuscenes", "vehicle.car", "table", "animal", {"table"}},
                                        {"nuscenes", "vehicle.car", "human.pedestrian.adult", "noise", {}},
                                        {"coco", "chair", "table", "ball", {}}};
  for (const ClassCase& each : cases) {
    for (const bool strict : {false, true}) {
      const TemporaryFolder folder;
      std::string scene = dataset_scene("color instance boxes", kScanned.contains(each.format) ? kDatasetScanner : "");
      const std::pair<const char*, std::string> classes[] = {
          {"\"chair\"", each.chair}, {"\"table\"", each.table}, {"\"ball\"", each.ball}};
      for (const auto& [old, name] : classes) {
        for (std::size_t at = 0; (at = scene.find(old, at)) != std::string::npos; at += name.size() + 1) {
          scene.replace(at, std::string_view(old).size(), "\"" + name + "\"");
        }
      }
      write_text(folder / "scene.xml", scene);
      Strings arguments = {
          (folder / "scene.xml").string(), "--frames", "3", "--quiet", "--dataset", each.format, "--out",
          (folder / "set").string()};
      if (strict) arguments.emplace_back("--strict");
      const ProcessResult result = run_simvis(arguments);
      CAPTURE(result.err);
      const bool fails = strict && !each.unknown.empty();  // with the first warning
      const std::size_t expected = fails ? 1 : each.unknown.size();
      CHECK(result.exit_code == (fails ? 2 : 0));
      CHECK(std::ranges::count(result.err, '\n') == static_cast<std::ptrdiff_t>(expected));
      for (std::size_t i = 0; i < expected; ++i) {
        CHECK(result.err.find("no color for the class \"" + each.unknown[i] + "\", and") != std::string::npos);
      }
      CHECK(fs::exists(folder / "set/contact_sheet.png") == !fails);
      if (!fails) continue;
      arguments.emplace_back("--resume");
      const ProcessResult again = run_simvis(arguments);
      CHECK(again.exit_code == 2);
      CHECK(again.err == result.err);
    }
  }
}

// The camera measures in the frames 0 and 2, which are key frames, and the scanner in all frames.
TEST_CASE("classes that nuscenes-devkit cannot draw are warned of in key frames only, which have boxes") {
  const TemporaryFolder folder;
  std::string scene = dataset_scene("color instance boxes", kDatasetScanner);
  scene.insert(scene.find(" width=\"96\""), " rate=\"10\"");
  write_text(folder / "scene.xml", scene);
  for (const std::string shard : {"1/2", "0/2"}) {
    CAPTURE(shard);
    const ProcessResult result =
        run_simvis({(folder / "scene.xml").string(), "--rate", "20", "--frames", "4", "--shard", shard, "--quiet",
                    "--dataset", "nuscenes", "--out", (folder / "set").string()});
    CAPTURE(result.err);
    CHECK(result.exit_code == 0);
    CHECK((result.err.find("no color for the class ") != std::string::npos) == (shard == "0/2"));
  }
}

TEST_CASE("scenes and runs that DSEC cannot hold have one message each") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& scene, const Strings& more, const std::string& expected) {
    write_text(folder / "scene.xml", scene);
    Strings all = {"--quiet", "--frames", "2", "--dataset", "dsec", "--out", (folder / "out").string()};
    all.insert(all.end(), more.begin(), more.end());
    check_no_dataset(folder / "scene.xml", all, expected);
    fs::remove_all(folder / "out");
  };
  const std::string
      events =
          "<sensor type='event_camera' name='EV' insert_at='CAR' width='96' height='72' hfov='70' step='1' "
          "time_error='0.01'/>",
      third = "<sensor type='event_camera' name='EV_THIRD' insert_at='CAR' width='8' height='8'/>";
  refused(dataset_scene("color", kDatasetEvents), {"--shard", "0/2"},
          "sensor \"EV_LEFT\" of type event_camera (exact areas) depends on the frames before");
  refused(dataset_scene("color"), {},
          "the scene has 0 event cameras and 1 views with colour that are on, expected one");
  refused(dataset_scene("color", kDatasetEvents + third), {}, "the scene has 3 event cameras and 2 views");
  refused(dataset_scene("color", events + kDatasetScanner), {}, "cannot hold the sensor \"SCAN\"");
  refused(dataset_scene("depth", events), {}, "camera \"CAM\" lacks outputs, expected at least outputs=\"color\"");
  refused(dataset_scene("color flow_forward\" pose_offset=\"0 0.1 0 0 0 0", events), {},
          "camera \"CAM\" measures flow_forward, which the format has once, for the event camera \"EV\"");
  refused(dataset_scene("color", events + third), {},
          "\"EV_THIRD\" is not to the right of \"EV\" with the same direction and picture");
  refused(dataset_scene("color\" distortion=\"brown_conrady\" k1=\"-0.1", events), {}, "camera \"CAM\" has a lens");
  refused(dataset_scene("color\" rate=\"7.5", events), {}, "not all sensors measure in frame 000001");
  // Nothing moves, which would be followed for 5000 s.
  refused("<simvis><sensor type='event_camera' name='EV' insert_at='ROOT' width='8' height='4'/></simvis>",
          {"--rate", "0.0002"},
          "frame 000001 is at 5000 s, and times of events end at 4294.967295 s, expected fewer frames");
  std::string elsewhere = events;
  elsewhere.replace(elsewhere.find("'CAR'"), 5, "'ROOT'");
  refused(dataset_scene("color", elsewhere), {}, "in frame 1 \"CAM\" is elsewhere relative to \"EV\" than in frame 0");
}

TEST_CASE("DSEC without events and without pictures is whole, and pieces that somebody has edited are one message") {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml",
             "<simvis><sensor type='event_camera' name='EV' insert_at='ROOT' width='8' height='4' "
             "shot_noise='20'/></simvis>");
  make_dataset(folder / "scene.xml", folder / "out", {"--dataset", "dsec"});
  Strings visible;
  for (const std::string& name : files_below(folder / "out")) {
    if (!name.starts_with(".simvis/")) visible.push_back(name);
  }
  CHECK(visible == Strings{"calibration/cam_to_cam.yaml", "events/left/events.h5", "events/left/rectify_map.h5"});
  const fs::path piece = folder / "out/.simvis/kept/left/000003.bin";
  REQUIRE(read_text(piece).size() > 9);
  const auto refused = [&](const std::string& expected) {
    check_no_dataset(folder / "scene.xml",
                     {"--quiet", "--frames", "4", "--dataset", "dsec", "--resume", "--out", (folder / "out").string()},
                     expected);
  };
  write_text(piece, read_text(piece) + "x");
  refused("kept/left/000003.bin: error: a record is not as simvis-run wrote it, expected another --out");
  fs::remove(piece);
  refused("000003.bin: error: cannot be read");
}

TEST_CASE("keypoints of COCO belong to a camera and to parts") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& sensor, const std::string& expected) {
    write_text(folder / "scene.xml",
               dataset_scene("color instance boxes", "<part name='CHAIR_1/seat' insert_at='CHAIR_1'/>" + sensor));
    check_no_dataset(folder / "scene.xml", {"--quiet", "--dataset", "coco", "--out", (folder / "out").string()},
                     expected);
    fs::remove_all(folder / "out");
  };
  const std::string picture = " width='96' height='72' hfov='70'/>";
  refused("<sensor type='keypoints' name='KEYS' insert_at='ROOT' points='CHAIR_1/*'" + picture,
          "keypoints \"KEYS\" in frame 000000: no camera has their place and picture");
  refused("<sensor type='keypoints' name='KEYS' insert_at='CAR' points='CHAIR_1/*' width='96' height='72'/>",
          "no camera has their place and picture");
  refused("<sensor type='keypoints' name='KEYS' insert_at='CAR' points='CHAIR_?'" + picture,
          "none of the points belongs to an object with a class, expected points that are inserted at one");
  refused("<sensor type='keypoints' name='KEYS' insert_at='CAR' points='CHAIR_1/*'" + picture +
              "<sensor type='keypoints' name='MORE' insert_at='CAR' points='CHAIR_?'" + picture,
          "keypoints \"MORE\" in frame 000000: none of the points belongs to an object with a class");
}

TEST_CASE("a scanner that is due less often than the cameras ends a KITTI dataset at that frame") {
  const TemporaryFolder folder;
  std::string scanner = kDatasetScanner;
  scanner.insert(scanner.find(" truth"), " rate='10'");
  write_text(folder / "scene.xml", dataset_scene("color", scanner));
  check_no_dataset(
      folder / "scene.xml",
      {"--quiet", "--dataset", "kitti", "--rate", "20", "--frames", "4", "--out", (folder / "out").string()},
      "not all sensors measure in frame 000001");
}

TEST_CASE("the contact sheet of a narrow picture is no taller than four tiles") {
  const TemporaryFolder folder;
  std::string scene = dataset_scene("color instance boxes");
  scene.replace(scene.find(R"(width="96" height="72")"), 22, R"(width="1" height="4096")");
  write_text(folder / "scene.xml", scene);
  make_dataset(folder / "scene.xml", folder / "out", {"--dataset", "coco"});
  const std::string png = read_text(folder / "out/contact_sheet.png");
  REQUIRE(png.size() > 24);
  // The height of a PNG is a big-endian number at byte 20; there are four rows of tiles, each 320 pixels wide.
  std::uint32_t height_px = 0;
  for (int i = 20; i < 24; ++i)
    height_px = height_px << 8 | static_cast<std::uint8_t>(png[static_cast<std::size_t>(i)]);
  CHECK(height_px <= 4 * 4 * 320);
}

}  // namespace
}  // namespace simvis
