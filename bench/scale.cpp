// Measures the cost of a frame as numbers grow: scanners, hidden instances, triangles to open and to hold, and frames.
//
//   scale [SECONDS [CURVE...]]
//
// Curves are sensors, instances, triangles, memory and frames; without a name all of them run. Prints CSV, one line for
// each point. Each point is measured in its own process, so that memory is that point's alone. SECONDS (5) is the time
// for each point, 18 times as much for the frames of each method. Columns that a curve does not measure stay empty.
//
// sensors    with 361 beams each on one robot in a lab of 100,000 triangles
// instances  of a box, in a store where only the first 100 are visible to any sensor; three scanners, or a camera from
//            which the ceiling hides many of the others
// triangles  of a lab: open_s is the time from the file to the first set of three scans, with an empty cache folder
//            (cold) and with a filled one (warm)
// frames     one scanner of 91 beams in a lab of 1,000 triangles; a line for each tenth of 10^6 (raycast) or 10^5
//            (planar) frames, as far as the time allows
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "bench/timing.h"

namespace {

using namespace simvis;
using namespace simvis::bench;

constexpr double kMega = 1e6;

/// Runs the work in its own process. This process must not have used Vulkan before.
void apart(const std::function<void()>& work) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    try {
      work();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "scale: %s\n", error.what());
      _exit(1);
    }
    std::fflush(stdout);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) std::exit(1);
}

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  statm >> pages >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / kMega;
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / kMega;
}

/// The size of all meshes and textures in host memory.
double data_mb(const DrawList& list) {
  double bytes = 0;
  std::set<const Texture*> textures;
  for (const std::shared_ptr<const Material>& material : list.materials) {
    textures.insert(material->base_color_texture.get());
    for (const SurfaceMap& map : material->maps) textures.insert(map.texture.get());
  }
  textures.erase(nullptr);
  for (const Texture* texture : textures) bytes += static_cast<double>(texture->rgba.size());
  for (const std::shared_ptr<const Mesh>& mesh : list.meshes) {
    bytes += static_cast<double>(mesh->positions.size() * sizeof(mesh->positions[0]) +
                                 mesh->attributes.size() * sizeof(mesh->attributes[0]) +
                                 mesh->indices.size() * sizeof(mesh->indices[0]));
  }
  return bytes / kMega;
}

/// The size of the passes' targets and readback buffers, by the names PASS/WHAT, and of the OIT layers.
double targets_mb(const FramePlan& plan) {
  double bytes = 0;
  for (const PlannedMemory& memory : plan.memory) {
    const bool layers = memory.name.find("transparent layers") != std::string::npos;
    if (layers || memory.name.find('/') != std::string::npos) bytes += static_cast<double>(memory.bytes);
  }
  return bytes / kMega;
}

struct Row {
  const char *curve, *method;
  double size = 0;
  double open_s = NAN;
  const char* cache = "";
  Took frame{NAN, NAN};
  std::string stages{};
};

void print(const Row& row, const Simulation& simulation) {
  const auto number = [](double value, const char* end) {
    if (std::isfinite(value)) std::printf("%.5g", value);
    std::printf("%s", end);
  };
  std::printf("%s,%.0f,%s,%s,", row.curve, row.size, row.method, row.cache);
  number(row.open_s, ",");
  number(row.frame.wall_ms, ",");
  number(row.frame.caller_ms, ",");
  const double device_mb = static_cast<double>(simulation.diagnostics().device_memory_bytes()) / kMega;
  std::printf("%.1f,%.1f,%.2f,%.2f,%.2f,%s\n", resident_mb(), peak_mb(), device_mb,
              targets_mb(simulation.diagnostics().frame_plan()), data_mb(simulation.diagnostics().draw_list()),
              row.stages.c_str());
  std::fflush(stdout);
}

SimulationDesc by(const std::string& method) {
  SimulationDesc desc;
  desc.overrides = {{"laser_scanner", "method", method, "METHOD"}};
  return desc;
}

/// Medians of frames and of their stages with the moving robot, over about this time.
void time_frames(Simulation& simulation, double seconds, Row& row) {
  constexpr int kWarmUp = 3, kMin = 5;
  std::vector<Took> took;
  std::vector<std::pair<std::string, std::vector<double>>> stages;
  double spent_ms = 0;
  for (int frame = 0; frame < kWarmUp + kMin || spent_ms < 1e3 * seconds; ++frame) {
    drive_lab(simulation, frame);
    const Took one = time_work([&] { simulation.step(); });
    if (frame < kWarmUp) continue;
    spent_ms += one.wall_ms;
    took.push_back(one);
    for (std::size_t i = 0; i < simulation.diagnostics().stages().size(); ++i) {
      const StageTime& stage = simulation.diagnostics().stages()[i];
      if (stages.size() <= i) stages.push_back({std::string(stage.name), {}});
      stages[i].second.push_back(static_cast<double>(stage.end_ns - stage.start_ns) / kMega);
    }
  }
  row.frame = median(took);
  for (const auto& [name, times_ms] : stages) {
    char text[64];
    std::snprintf(text, sizeof text, "%s%s %.4f", row.stages.empty() ? "" : "; ", name.c_str(), median(times_ms));
    row.stages += text;
  }
}

std::string scanners(int count) {
  std::string xml;
  for (int i = 0; i < count; ++i) {
    xml += "<sensor type=\"laser_scanner\" name=\"S" + std::to_string(i) + "\" insert_at=\"ROBOT\" pose_offset=\"0 0 " +
           std::to_string(0.9 + 0.005 * i) + " 0 0 " + std::to_string(i * 37 % 360) + "\"/>\n";
  }
  return xml;
}

void sensors(double seconds) {
  for (const char* method : {"planar", "raycast"}) {
    for (const int count : {1, 3, 10, 30, 100}) {
      apart([&] {
        const SceneFolder folder;
        Simulation simulation = Simulation::load(write_lab(folder.path(), 100'000, scanners(count)), by(method));
        Row row{.curve = "sensors", .method = method, .size = static_cast<double>(count)};
        time_frames(simulation, seconds, row);
        print(row, simulation);
      });
    }
  }
}

constexpr const char* kCamera = R"(<sensor type="camera" name="CAMERA" insert_at="ROBOT" pose_offset="0 0 1 0 0 0"/>)";

void instances(double seconds) {
  for (const std::string method : {"planar", "raycast", "camera"}) {
    for (const std::size_t count : {100, 1'000, 10'000, 100'000}) {
      apart([&] {
        const SceneFolder folder;
        Simulation simulation = method == "camera" ? Simulation::load(write_store(folder.path(), count, kCamera))
                                                   : Simulation::load(write_store(folder.path(), count), by(method));
        Row row{.curve = "instances", .method = method.c_str(), .size = static_cast<double>(count)};
        time_frames(simulation, seconds, row);
        print(row, simulation);
      });
    }
  }
}

void triangles(double seconds) {
  for (const std::size_t count : {100'000, 1'000'000, 10'000'000}) {
    const SceneFolder folder;
    const std::filesystem::path scene = write_lab(folder.path(), count);
    for (const char* method : {"planar", "raycast"}) {
      const std::string cache_dir = folder.path() / "cache" / method;
      std::filesystem::create_directories(cache_dir);
      for (const char* cache : {"cold", "warm"}) {
        apart([&] {
          SimulationDesc desc = by(method);
          desc.device.cache_dir = cache_dir;
          setenv("XDG_CACHE_HOME", cache_dir.c_str(), 1);
          std::optional<Simulation> simulation;
          const Took opened = time_work([&] {
            simulation = Simulation::load(scene, desc);
            simulation->step();
          });
          Row row{.curve = "triangles",
                  .method = method,
                  .size = static_cast<double>(triangles_of(simulation->diagnostics().draw_list())),
                  .open_s = opened.wall_ms / 1e3,
                  .cache = cache};
          time_frames(*simulation, seconds, row);
          print(row, *simulation);
        });
      }
    }
  }
}

void memory() {
  apart([] {
    Simulation simulation = Simulation::load(SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml");
    simulation.enable("VIEW_CAM", false);
    simulation.step();
    print({.curve = "memory",
           .method = "",
           .size = static_cast<double>(triangles_of(simulation.diagnostics().draw_list()))},
          simulation);
  });
}

void frames(double seconds) {
  constexpr int kTenths = 10;
  const std::pair<const char*, int> runs[] = {{"raycast", 1'000'000}, {"planar", 100'000}};
  for (const auto& [method, count] : runs) {
    apart([&, method = method, count = count] {
      const SceneFolder folder;
      const char* const scanner =
          "<sensor type=\"laser_scanner\" name=\"SCANNER\" insert_at=\"ROBOT\" pose_offset=\"0 0 1 0 0 0\" "
          "samples=\"91\"/>";
      Simulation simulation = Simulation::load(write_lab(folder.path(), 1000, scanner), by(method));
      const auto start = std::chrono::steady_clock::now();
      std::vector<Took> took;
      took.reserve(static_cast<std::size_t>(count / kTenths));  // so that only SimVis allocates memory
      for (int frame = 1; frame <= count && since_ms(start) < 1e3 * seconds; ++frame) {
        drive_lab(simulation, frame);
        took.push_back(time_work([&] { simulation.step(); }));
        if (frame % (count / kTenths) != 0) continue;
        print({.curve = "frames", .method = method, .size = static_cast<double>(frame), .frame = median(took)},
              simulation);
        took.clear();
      }
    });
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 5;
  constexpr double kForFrames = 18;
  const std::pair<const char*, std::function<void()>> curves[] = {{"sensors", [&] { sensors(seconds); }},
                                                                  {"instances", [&] { instances(seconds); }},
                                                                  {"triangles", [&] { triangles(seconds); }},
                                                                  {"memory", [&] { memory(); }},
                                                                  {"frames", [&] { frames(kForFrames * seconds); }}};
  std::printf(
      "curve,size,method,cache,open_s,median_ms,caller_cpu_ms,rss_mb,peak_rss_mb,device_mb,targets_mb,data_mb,"
      "stages\n");
  for (const auto& [name, run] : curves) {
    const bool asked = std::any_of(argv + std::min(argc, 2), argv + argc,
                                   [&, name = name](const char* arg) { return std::string(name) == arg; });
    if (asked || argc <= 2) run();
  }
  return 0;
}
