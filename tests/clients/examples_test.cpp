// The examples for clients: the same robot driver in C, C++ and Python drives the same way; three programs together.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "tests/clients/python_client.h"
#include "tests/clients/shared_host.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

const std::string kExamples = SIMVIS_SOURCE_DIR "/exchange/clients/examples/";
const std::string kMarvin = SIMVIS_SOURCE_DIR "/scenes/marvin/";

bool has_numpy() { return Process({"/usr/bin/python3", "-c", "import numpy"}).wait().exit_code == 0; }

void compile(const std::vector<std::string>& compiler, const std::string& source, const std::string& program) {
  const std::string libraries = tested_build() + "/lib";
  std::vector<std::string> command = compiler;
  command.insert(command.end(), {"-Wall", "-Wextra", "-Werror", "-I" SIMVIS_SOURCE_DIR "/include", kExamples + source,
                                 "-o", program, "-L" + libraries, "-Wl,-rpath," + libraries, "-lsimvis-client", "-lm"});
  const ProcessResult result = Process(command).wait();
  REQUIRE_MESSAGE(result.exit_code == 0, result.err);
}

struct Place {
  double x_m, y_m;
};

/// Where the robot is in each frame that it is driven.
std::vector<Place> drive(const std::vector<std::string>& driver, int frames) {
  const TemporaryFolder folder;
  const std::string name = unique_name("drive");
  std::vector<std::string> command = driver;
  command.push_back(name);
  Process client(command, python_client_environment());  // and those in C, which are built without sanitizers, too
  const ProcessResult host =
      Process({tested_build() + "/bin/simvis-run", "--quiet", "--serve", name, "--lockstep", "driver",
               "--lockstep-timeout", "60", "--frames", std::to_string(frames), "--sensor", "FRONT_SCANNER", "--poses",
               "ROBOT", "--out", folder.path().string(), kMarvin + "marvin.xml"})
          .wait();
  REQUIRE_MESSAGE(host.exit_code == 0, host.err);
  const ProcessResult ended = client.wait();
  CHECK_MESSAGE(ended.exit_code == 0, ended.err);
  std::istringstream lines(read_text(folder.path() / "ROBOT_poses.csv"));
  std::vector<Place> places;
  std::string line;
  std::getline(lines, line);
  REQUIRE(line.starts_with("frame,time_s,x_m,y_m"));
  while (std::getline(lines, line)) {
    Place place{};
    REQUIRE(std::sscanf(line.c_str(), "%*d,%*f,%lf,%lf", &place.x_m, &place.y_m) == 2);
    places.push_back(place);
  }
  return places;
}

}  // namespace

TEST_CASE("the driver in C, in C++ and in Python: all drive the robot the same way through the laboratory") {
  constexpr int kFrames = 60;
  // The languages round angles differently in their last digits, 10^-15 of them in each frame.
  constexpr double kRounding_m = 1e-9;
  const TemporaryFolder folder;
  const std::string c = (folder.path() / "c").string(), cpp = (folder.path() / "cpp").string();
  compile({"cc", "-std=c11"}, "driver.c", c);
  compile({SIMVIS_CXX_COMPILER, "-std=c++20"}, "driver.cpp", cpp);
  const std::vector<Place> way = drive({c}, kFrames);
  REQUIRE(way.size() == kFrames);
  CHECK(std::hypot(way.back().x_m - way.front().x_m, way.back().y_m - way.front().y_m) > 0.5);
  std::vector<std::vector<Place>> others{drive({cpp}, kFrames)};
  if (has_numpy()) others.push_back(drive({"/usr/bin/python3", kExamples + "driver.py"}, kFrames));
  for (const std::vector<Place>& other : others) {
    REQUIRE(other.size() == way.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
      CHECK(std::abs(other[i].x_m - way[i].x_m) <= kRounding_m);
      CHECK(std::abs(other[i].y_m - way[i].y_m) <= kRounding_m);
    }
  }
}

TEST_CASE("scenes/marvin/three_programs: host, driver and follower") {
  if (!has_numpy()) return test::skip("there is no NumPy for /usr/bin/python3");
  const TemporaryFolder folder;
  const ProcessResult result = Process({"/bin/sh", kMarvin + "three_programs", "30", folder.path().string()},
                                       {"SIMVIS_RUN=" + tested_build() + "/bin/simvis-run"})
                                   .wait();
  CHECK_MESSAGE(result.exit_code == 0, result.err);
  CHECK(result.out.find("last picture: " + folder.path().string() + "/seen/VIEW/") != std::string::npos);
  CHECK(std::filesystem::exists(folder.path() / "host" / "FRONT_SCANNER.csv"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "host" / "VIEW_CAM"));
}

TEST_SUITE_END();
