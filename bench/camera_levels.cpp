// Measures what the dial of cameras, max_error_px, costs in time and what it changes in the picture.
//
//   camera_levels [FRAMES [SCENE.xml CAMERA]...]
//
// Prints CSV: the price list of simvis-run --price for WORLD_CAM of scenes/ravon, ROBOT_CAM of scenes/marvin, which has
// depth too, and cameras in a lab of a million triangles, before 200 distant robots of 24,000 triangles each, and on a
// landscape of a million triangles. Nothing moves. Values take turns in every frame: compare ratios, on a busy machine
// those of the processor time.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/scenes/dense.h"
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "program/report/camera_costs.h"

namespace {

using namespace simvis;

constexpr int kFramesOfEach = 5;

/// The price list without its first line, each line with the scene before it; the first line, too, if it is the first
/// scene.
void print(const std::string& name, const std::filesystem::path& scene, const std::string& camera, int frames) {
  static bool first = true;
  Simulation simulation = Simulation::load(scene);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == camera);
  CostDesc desc;
  desc.frames = static_cast<std::uint64_t>(frames);
  const std::string table = to_csv(camera_costs(std::move(simulation), desc));
  std::size_t line = 0;
  for (bool heading = true; line < table.size(); heading = false) {
    const std::size_t end = table.find('\n', line) + 1;
    const std::string text = table.substr(line, end - line);
    if (!heading) std::printf("%s,%s", name.c_str(), text.c_str());
    if (heading && first) std::printf("scene,%s", text.c_str());
    line = end;
  }
  first = false;
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : kFramesOfEach;
  if (argc > 2) {
    for (int i = 2; i + 1 < argc; i += 2) print(std::filesystem::path(argv[i]).stem(), argv[i], argv[i + 1], frames);
    return 0;
  }
  print("ravon", SIMVIS_SOURCE_DIR "/scenes/ravon/ravon.xml", "WORLD_CAM", frames);
  print("marvin", SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml", "ROBOT_CAM", frames);
  const bench::SceneFolder folder;
  const auto camera = [](const char* point, const char* pose) {
    return std::string(R"(<sensor type="camera" name="CAMERA" width="640" height="480" insert_at=")") + point +
           R"(" pose_offset=")" + pose + R"("/>)";
  };
  print("lab 1M", bench::write_lab(folder.path(), 1'000'000, camera("ROBOT", "0 0 1.5 0 0 0")), "CAMERA", frames);
  print("200 robots", bench::write_fleet(folder.path(), 200, camera("ROOT", "0 0 2 0 5 0")), "CAMERA", frames);
  print("terrain 1M", bench::write_terrain(folder.path(), 1'000'000, camera("ROOT", "0 0 2 0 3 0")), "CAMERA", frames);
  return 0;
}
