// A live cloud: the points of a scanner with a million beams, drawn for people in every frame.
//
//   live_cloud [FRAMES [PICTURE.png]]
//
// Prints CSV, a line for each part of a frame, in turns: the scan alone, and the scan with the cloud in a camera's
// picture. Times are medians of wall-clock time, and of the processor time of all threads, which other load affects
// less. PICTURE.png gets the last picture.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "bench/timing.h"
#include "scenegraph/pictures/png_file.h"

namespace {

using namespace simvis;

constexpr int kWarmUp = 2;

constexpr const char* kRoom = R"(
<part name="ROOM" insert_at="ROOT" shape="box" size="20 16 5" pose_offset="0 0 1.5 0 0 0"/>
<part name="A" insert_at="ROOT" shape="box" size="1 2 1" pose_offset="4 1 0 0 0 0"/>
<part name="B" insert_at="ROOT" shape="sphere" radius="1" pose_offset="-3 3 0.5 0 0 0"/>
<part name="C" insert_at="ROOT" shape="cylinder" radius="0.5" length="3" pose_offset="2 -4 0.5 0 0 0"/>
<sensor type="laser_scanner" name="S" insert_at="ROOT" samples="4000" min_angle="-180" max_angle="179.91"
        vertical_samples="250" vertical_min_angle="-40" vertical_max_angle="40"/>
)";
constexpr const char* kForPeople = R"(
<element type="point_cloud" name="P" insert_at="ROOT" scanner="S"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="960" height="540" hfov="80" view="visualization"
        pose_offset="-8 -6 3 0 20 40"/>
)";

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Times {
  std::vector<double> wall_ms, processor_ms;
};

void time_frame(Simulation& simulation, bool counts, Times& times) {
  const double before_ms = processor_ms();
  const auto start = std::chrono::steady_clock::now();
  simulation.step();
  if (!counts) return;
  times.wall_ms.push_back(bench::since_ms(start));
  times.processor_ms.push_back(processor_ms() - before_ms);
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 15;
  Simulation scan = Simulation::from_string(kRoom), cloud = Simulation::from_string(std::string(kRoom) + kForPeople);
  Times of_scan, of_cloud;
  for (int frame = -kWarmUp; frame < frames; ++frame) {
    time_frame(scan, frame >= 0, of_scan);
    time_frame(cloud, frame >= 0, of_cloud);
  }
  std::printf("frame,wall_ms,processor_ms\n");
  std::printf("scan,%.1f,%.1f\n", bench::median(of_scan.wall_ms), bench::median(of_scan.processor_ms));
  std::printf("scan and cloud,%.1f,%.1f\n", bench::median(of_cloud.wall_ms), bench::median(of_cloud.processor_ms));
  if (argc > 2) std::ofstream(argv[2], std::ios::binary) << encode_png(cloud.color("CAM"));
  return 0;
}
