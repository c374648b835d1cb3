// Measures the time until the first picture: from the start of the process until a frame of one camera of scenes/marvin
// is written to disk, with an empty cache folder (every pipeline is compiled) and with a filled one.
//
//   first_image [SCENE.xml [CAMERA [REPEATS]]]
//
// Prints one CSV line per case: the case, and the median and the minimum of the repeats in milliseconds.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

// Runs simvis-run for one frame; returns the milliseconds until it has ended and results are written. Exits if it
// fails.
double run_once(const std::string& scene, const std::string& camera, const std::filesystem::path& folder) {
  const std::string out = (folder / "out").string();
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
    execl(SIMVIS_RUN, SIMVIS_RUN, "--quiet", "--sensor", camera.c_str(), "--out", out.c_str(), scene.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::fprintf(stderr, "first_image: %s failed\n", SIMVIS_RUN);
    std::exit(1);
  }
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void print(const char* name, std::vector<double> milliseconds) {
  std::ranges::sort(milliseconds);
  std::printf("%s,%.0f,%.0f\n", name, milliseconds[milliseconds.size() / 2], milliseconds.front());
}

}  // namespace

int main(int argc, char** argv) {
  const std::string scene = argc > 1 ? argv[1] : SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const std::string camera = argc > 2 ? argv[2] : "ROBOT_CAM";
  const int repeats = argc > 3 ? std::max(1, std::atoi(argv[3])) : 7;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("simvis_first_image_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);

  std::vector<double> cold, warm;
  for (int i = 0; i < repeats; ++i) {
    std::filesystem::remove_all(folder / "cache");
    cold.push_back(run_once(scene, camera, folder));
    warm.push_back(run_once(scene, camera, folder));
  }
  std::filesystem::remove_all(folder);
  std::printf("case,median_ms,least_ms\n");
  print("cold cache", cold);
  print("warm cache", warm);
  return 0;
}
