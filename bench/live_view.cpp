// Measures what viewers cost a simulation, and how long a slider's move takes to the next measurement.
//
//   live_view [FRAMES [SCENE]]
//
// Prints CSV, of all scenes or one: marvin, 10,000 parts of one box before a camera and a scanner, a lab of a
// million triangles with the same sensors. Frames are called for at 15 Hz, in blocks with 0, 1 and 4 viewers in turn,
// each of which looks at all sensors, reads all that comes and shows it at once. Medians, in ms: `frame_ms` is the time
// of step() and of handing the frame to the server, `process_ms` the processor time of all threads meanwhile,
// `thread_ms` that of the simulation's thread, `publish_ms` that of its second part alone. `cost` is `publish_ms` over
// the shortest time in which the machine can make a frame without viewers: `process_ms` of that over the number of
// cores. With one viewer: `slider_ms`, the time from a client's `set` to the first measurement of a frame that was made
// after it; `glb_mb`, the size of the scene as the page gets it, and `glb_ms`, the time until it has arrived.
#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <simvis/simulation.h>
#include "bench/live_viewer.h"
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "bench/timing.h"
#include "program/live/live_view.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace simvis;
using bench::Took;

constexpr double kRate_hz = 15;
constexpr int kBlocks = 3, kSliderMoves = 9;

/// A page that looks at everything.
struct Viewer : LiveViewer {
  explicit Viewer(std::uint16_t port) : LiveViewer(port), scene(receive_op("scene")) {
    nlohmann::json sensors = nlohmann::json::array();
    for (std::size_t i = 0; i < scene.at("sensors").size(); ++i) sensors.push_back(i);
    send({{"op", "look"}, {"sensors", sensors}, {"plan", true}});
  }
  nlohmann::json scene;
};

/// Reads until `viewer` is shut down.
void read_all(LiveViewer& viewer) {
  try {
    for (;;) viewer.receive();
  } catch (const std::runtime_error&) {  // it was
  }
}

/// One entry per frame.
struct Measured {
  std::vector<Took> frame, publish;
  std::vector<double> process_ms;
};

double process_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

class Run {
 public:
  explicit Run(Simulation simulation) : simulation_(std::move(simulation)) { view_.attach(simulation_); }
  std::uint16_t port() const { return view_.port(); }

  void frame(Measured& measured) {
    std::this_thread::sleep_until(due_);
    due_ = std::max(due_ + std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / kRate_hz)), Clock::now());
    while (const std::optional<live::Control> control = view_.next_control()) {
      for (const auto& [parameter, value] : control->values) simulation_.parameters().set(parameter, value);
    }
    const FrameTime time = simulation_.next_frame();
    Took step, publish;
    const double process = process_ms();
    const Took whole = bench::time_work([&] {
      step = bench::time_work([&] { simulation_.step(); });
      publish = bench::time_work(
          [&] { view_.publish(simulation_, time, step.wall_ms, {.speed = 1, .playing = true, .recorded = false}); });
    });
    measured.frame.push_back(whole);
    measured.publish.push_back(publish);
    measured.process_ms.push_back(process_ms() - process);
  }

 private:
  live::LiveView view_{live::ServerDesc{.address = "127.0.0.1", .token = kLiveToken}};
  Simulation simulation_;
  Clock::time_point due_ = Clock::now();
};

/// Runs `action` on another thread while frames are made; its messages are read there.
template <typename Action>
void while_running(Run& run, const Action& action) {
  std::atomic<bool> done = false;
  std::thread other([&] {
    action();
    done = true;
  });
  for (Measured ignored; !done;) run.frame(ignored);
  other.join();
}

bool has_value(const nlohmann::json& message, double value) {
  return std::ranges::any_of(message.at("values"), [&](const auto& each) { return each[0] == 0 && each[1] == value; });
}

struct Responses {
  double slider_ms = 0, glb_mb = 0, glb_ms = 0;
};

Responses measure_responses(Run& run) {
  Responses responses;
  while_running(run, [&] {
    Viewer viewer(run.port());
    std::vector<double> times;
    for (int i = 0; i < kSliderMoves; ++i) {
      const double value = 0.01 * (i + 1);
      const Clock::time_point start = Clock::now();
      viewer.send({{"op", "set"}, {"parameter", 0}, {"value", value}});
      while (!has_value(viewer.receive_op("values"), value)) {
      }
      while (viewer.receive().bytes.front() == 1) {  // transforms
      }
      times.push_back(bench::since_ms(start));
    }
    responses.slider_ms = bench::median(times);
    const Clock::time_point start = Clock::now();
    const std::size_t size = LiveViewer(run.port(), false).get("/" + viewer.scene.at("glb").get<std::string>());
    responses.glb_ms = bench::since_ms(start);
    responses.glb_mb = static_cast<double>(size) / 1e6;
  });
  return responses;
}

/// Adds `frames` frames with so many viewers.
void measure_block(Run& run, int viewers, int frames, Measured& measured) {
  std::vector<std::unique_ptr<Viewer>> all;
  while_running(run, [&] {
    for (int i = 0; i < viewers; ++i) all.push_back(std::make_unique<Viewer>(run.port()));
  });
  std::vector<std::thread> readers;
  for (const std::unique_ptr<Viewer>& viewer : all) {
    readers.emplace_back([&viewer] { read_all(*viewer); });
  }
  for (int i = 0; i < frames; ++i) run.frame(measured);
  for (const std::unique_ptr<Viewer>& viewer : all) viewer->shut_down();
  for (std::thread& reader : readers) reader.join();
}

void measure(const std::string& name, const std::filesystem::path& scene, int frames) {
  Run run(Simulation::load(scene));
  Measured warm_up;
  for (int i = 0; i < 5; ++i) run.frame(warm_up);
  std::map<int, Measured> by_viewers;
  for (int block = 0; block < kBlocks; ++block) {
    for (const int viewers : {0, 1, 4}) measure_block(run, viewers, frames, by_viewers[viewers]);
  }
  const Responses responses = measure_responses(run);
  const double alone_ms = bench::median(by_viewers[0].process_ms) / std::thread::hardware_concurrency();
  for (const auto& [viewers, measured] : by_viewers) {
    const Took frame = bench::median(measured.frame), publish = bench::median(measured.publish);
    std::printf("%s,%d,%zu,%.3f,%.3f,%.3f,%.3f,%.4f", name.c_str(), viewers, measured.frame.size(), frame.wall_ms,
                bench::median(measured.process_ms), frame.caller_ms, publish.caller_ms, publish.caller_ms / alone_ms);
    if (viewers == 1) std::printf(",%.1f,%.1f,%.0f\n", responses.slider_ms, responses.glb_mb, responses.glb_ms);
    if (viewers != 1) std::printf(",,,\n");
  }
  std::fflush(stdout);
}

const std::string kSensors = R"(
  <sensor type="camera" name="CAM" insert_at="ROBOT" width="640" height="480" outputs="color depth"/>
  <sensor type="laser_scanner" name="FRONT" insert_at="ROBOT" samples="361" min_angle="-90" max_angle="90"/>)";

std::filesystem::path write_parts(const std::filesystem::path& folder, int count) {
  std::string xml =
      "<simvis>\n<part name=\"ROBOT\" insert_at=\"ROOT\" shape=\"box\" size=\"0.1 0.1 0.1\"/>\n"
      "<element type=\"pose\" name=\"MOVE\" insert_at=\"ROBOT\"/>\n" +
      kSensors;
  for (int i = 0; i < count; ++i) {
    xml += "<part name=\"BOX_" + std::to_string(i) +
           "\" insert_at=\"ROOT\" shape=\"box\" size=\"0.2 0.2 0.2\" pose_offset=\"" +
           std::to_string(2 + 0.5 * (i % 100)) + " " + std::to_string(0.5 * (i / 100) - 25) + " 0 0 0 0\"/>\n";
  }
  std::ofstream(folder / "parts.xml") << xml << "</simvis>\n";
  return folder / "parts.xml";
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 20;
  const std::string only = argc > 2 ? argv[2] : "";
  const bench::SceneFolder folder;
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);  // as simvis-run: memory that is freed is kept
  ::mallopt(M_TRIM_THRESHOLD, 256 << 20);
  std::printf("scene,viewers,frames,frame_ms,process_ms,thread_ms,publish_ms,cost,slider_ms,glb_mb,glb_ms\n");
  const auto wanted = [&](const std::string& scene) { return only.empty() || only == scene; };
  if (wanted("marvin")) measure("marvin", SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml", frames);
  if (wanted("10000 parts")) measure("10000 parts", write_parts(folder.path(), 10'000), frames);
  if (wanted("1000000 triangles")) {
    measure("1000000 triangles", bench::write_lab(folder.path(), 1'000'000, kSensors), frames);
  }
}
