// Measures what a frame of one camera costs, in the scenes of bench/camera_peers and with the things that cost most.
//
//   camera_frames [FRAMES [CASE...]]
//   camera_frames --export FOLDER
//
// Prints CSV: for each case the median and the least of wall-clock time and of processor time, all threads together.
// Cases are taken in turns of a few frames, so that what else the machine does hits all alike. Processor time hardly
// depends on other programs: compare it where the machine is busy. With --export it writes one frame of each scene for
// the peers.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/scene_export.h"
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "bench/timing.h"

namespace {

using namespace simvis;

constexpr int kTurn = 5;  // frames

// A case with more settings than these, the size of the picture and its output, shows a scene of another case.
constexpr std::size_t kSceneSettings = 3;

double process_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

using Settings = std::vector<std::pair<std::string, std::string>>;  ///< attributes of every camera

struct Case {
  std::string name;
  std::filesystem::path scene;
  std::string camera;
  Settings settings;
  std::function<void(Simulation&, int frame)> drive;
};

class Run {
 public:
  explicit Run(const Case& of) : drive_(of.drive) {
    SimulationDesc desc;
    for (const auto& [name, value] : of.settings) desc.overrides.push_back({"camera", name, value, name});
    desc.overrides.push_back({"camera", "view", std::nullopt, "view"});  // one for people gives no truth
    simulation_ = std::make_unique<Simulation>(Simulation::load(of.scene, desc));
    for (const SensorInfo& sensor : simulation_->sensors()) {
      simulation_->enable(sensor.name, sensor.name == of.camera);
    }
    step();
    step();
  }

  void turn(int frames) {
    for (int i = 0; i < frames; ++i) {
      const double before = process_ms();
      wall_ms_.push_back(bench::time_work([&] { step(); }).wall_ms);
      processor_ms_.push_back(process_ms() - before);
    }
  }

  void write(const std::filesystem::path& folder, const std::string& name) const {
    bench::export_frame(*simulation_, folder, name);
  }

  void print(const std::string& name) const {
    std::printf("%s,%zu,%.2f,%.2f,%.2f,%.2f\n", name.c_str(), wall_ms_.size(), bench::median(wall_ms_),
                bench::quantile(wall_ms_, 0), bench::median(processor_ms_), bench::quantile(processor_ms_, 0));
  }

 private:
  void step() {
    drive_(*simulation_, frame_++);
    simulation_->step();
  }

  std::function<void(Simulation&, int frame)> drive_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<double> wall_ms_, processor_ms_;
  int frame_ = 0;
};

/// marvin's room with seven point lights that cast shadows in place of its six lamps. The sun of the room stays.
std::filesystem::path write_lamps(const std::filesystem::path& folder, const std::filesystem::path& marvin) {
  constexpr std::pair<double, double> kPlaces_m[] = {{-4, 2.2}, {0, 2.2},  {4, 2.2}, {-4, -2.2},
                                                     {0, -2.2}, {4, -2.2}, {0, 0}};
  const std::string file = "file=\"", end = "</simvis>";
  std::ifstream in(marvin);
  std::string scene;
  for (std::string line; std::getline(in, line);) {
    if (line.find("lamp.glb") != std::string::npos) continue;
    if (const std::size_t at = line.find(file); at != std::string::npos) {
      line.insert(at + file.size(), marvin.parent_path().string() + "/");
    }
    scene += line + "\n";
  }
  std::string lamps;
  for (const auto& [x, y] : kPlaces_m) {
    lamps += "<element type=\"light\" name=\"LIGHT_" + std::to_string(lamps.size()) +
             "\" insert_at=\"LAB\" kind=\"point\" x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) +
             "\" z=\"2.6\" intensity=\"4\" shadows=\"yes\"/>\n";
  }
  scene.insert(scene.rfind(end), lamps);
  const std::filesystem::path written = folder / "lamps.xml";
  std::ofstream(written) << scene;
  return written;
}

std::vector<Case> cases(const std::filesystem::path& folder) {
  const std::filesystem::path marvin = SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const auto drive = [path = marvin.parent_path() / "drive.csv"](Simulation& simulation, int) {
    const Trajectory trajectory(path, simulation.parameters());
    trajectory.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
  };
  const auto of_marvin = [&](const char* name, const char* camera, Settings more) {
    Settings settings{{"width", "640"}, {"height", "480"}};
    settings.insert(settings.end(), more.begin(), more.end());
    return Case{name, marvin, camera, std::move(settings), drive};
  };
  std::vector<Case> all{of_marvin("marvin robot", "ROBOT_CAM", {{"outputs", "color"}}),
                        of_marvin("marvin room", "ROOM_CAM", {{"outputs", "color"}}),
                        of_marvin("marvin robot depth", "ROBOT_CAM", {{"outputs", "depth"}, {"msaa", "1"}}),
                        of_marvin("marvin room depth", "ROOM_CAM", {{"outputs", "depth"}, {"msaa", "1"}}),
                        of_marvin("marvin robot msaa 4", "ROBOT_CAM", {{"outputs", "color"}, {"msaa", "4"}}),
                        of_marvin("marvin room msaa 4", "ROOM_CAM", {{"outputs", "color"}, {"msaa", "4"}})};
  for (const char* const outputs :
       {"depth", "range", "instance semantic", "instance semantic range", "object_coordinates",
        "depth depth_error_bound", "flow_backward", "instance semantic range flow_backward", "normal", "flow_forward",
        "flow_backward flow_forward", "flow_backward occlusion", "layers"}) {
    all.push_back(
        of_marvin("marvin robot and ", "ROBOT_CAM", {{"outputs", std::string("color ") + outputs}, {"msaa", "1"}}));
    all.back().name += outputs;
  }
  // The settings keep them out of --export.
  const Settings lit{{"width", "640"}, {"height", "480"}, {"outputs", "color"}, {"msaa", "1"}};
  const std::filesystem::path lamps = write_lamps(folder, marvin);
  all.push_back({"marvin robot 7 shadows", lamps, "ROBOT_CAM", lit, drive});
  all.push_back({"marvin robot 7 shadows still", lamps, "ROBOT_CAM", lit, [](Simulation&, int) {}});
  const std::string camera =
      R"(<sensor type="camera" name="CAMERA" insert_at="ROBOT" width="640" height="480" pose_offset="0 0 1.5 0 0 0"/>)";
  for (const auto& [name, triangles] :
       {std::pair{"10k", 10'000}, std::pair{"100k", 100'000}, std::pair{"1M", 1'000'000}}) {
    std::filesystem::create_directories(folder / name);
    all.push_back({std::string("lab ") + name,
                   bench::write_lab(folder / name, static_cast<std::size_t>(triangles), camera),
                   "CAMERA",
                   {},
                   bench::drive_lab});
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--export") {
    const bench::SceneFolder scenes;
    for (const Case& of : cases(scenes.path())) {
      if (of.settings.size() <= kSceneSettings) Run(of).write(argv[2], of.name);
    }
    return 0;
  }
  const int frames = argc > 1 ? std::max(kTurn, std::atoi(argv[1])) : 60;
  const std::set<std::string> wanted(argv + std::min(argc, 2), argv + argc);
  const bench::SceneFolder folder;
  std::vector<std::pair<std::string, Run>> runs;
  for (const Case& of : cases(folder.path())) {
    if (wanted.empty() || wanted.contains(of.name)) runs.emplace_back(of.name, Run(of));
  }
  for (int done = 0; done < frames; done += kTurn) {
    for (auto& [name, run] : runs) run.turn(kTurn);
  }
  std::printf("case,frames,median_ms,least_ms,processor_ms,least_processor_ms\n");
  for (const auto& [name, run] : runs) run.print(name);
  return 0;
}
