// Measures what viewers cost the simulation, and how long a slider's move takes to the next picture.
//
//   live_view [SCENE.xml [FRAMES]]
//
// Prints CSV. Frames of the scene (default: marvin) are called for at 15 Hz, in blocks with 0, 1 and 4 viewers in turn,
// each of which looks at all sensors and reads all that comes. `frame_ms` is the time of step() and of handing the
// frame to the server, `publish_ms` the second part of it, `thread_ms` the processor time of the simulation's thread
// for both: medians. `server` rows: the time from a `set` of a client to the first picture of a frame that was made
// after it, and the size of the scene as a GLB with the time until it has arrived.
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include <simvis/simulation.h>
#include "bench/live_viewer.h"
#include "live/live_view.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace simvis;

constexpr double kRate_hz = 15;

double thread_ms() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? 0 : values[values.size() / 2];
}

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

/// Times of frames in milliseconds; each list has one entry per frame.
struct Measured {
  std::vector<double> frame, publish, thread;
};

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
    const Clock::time_point start = Clock::now();
    const double processor = thread_ms();
    simulation_.step();
    const double step_ms = ms_since(start);
    view_.publish(simulation_, time, step_ms, {.speed = 1, .playing = true, .recorded = false});
    measured.frame.push_back(ms_since(start));
    measured.publish.push_back(measured.frame.back() - step_ms);
    measured.thread.push_back(thread_ms() - processor);
  }

 private:
  live::LiveView view_{live::ServerDesc{.address = "127.0.0.1", .token = ""}};
  Simulation simulation_;
  Clock::time_point due_ = Clock::now();
};

/// Runs `action` on another thread while frames are made; its messages are read there.
template <typename Action>
void while_running(Run& run, Measured& measured, const Action& action) {
  std::atomic<bool> done = false;
  std::thread other([&] {
    action();
    done = true;
  });
  while (!done) run.frame(measured);
  other.join();
}

bool has_value(const nlohmann::json& message, double value) {
  return std::ranges::any_of(message.at("values"), [&](const auto& each) { return each[0] == 0 && each[1] == value; });
}

void measure_slider(Run& run) {
  Measured ignored;
  std::vector<double> times;
  while_running(run, ignored, [&] {
    Viewer viewer(run.port());
    for (int i = 0; i < 30; ++i) {
      const double value = 0.01 * (i + 1);
      const Clock::time_point start = Clock::now();
      viewer.send({{"op", "set"}, {"parameter", 0}, {"value", value}});
      while (!has_value(viewer.receive_op("values"), value)) {
      }
      while (!viewer.receive().binary) {
      }
      times.push_back(ms_since(start));
    }
    const Clock::time_point start = Clock::now();
    const std::size_t size = LiveViewer(run.port(), false).get("/" + viewer.scene.at("glb").get<std::string>());
    std::printf("server,glb_bytes,%zu\nserver,glb_ms,%.1f\n", size, ms_since(start));
  });
  std::printf("server,slider_to_picture_ms,%.1f\n", median(times));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string scene = argc > 1 ? argv[1] : std::string(SIMVIS_SOURCE_DIR) + "/scenes/marvin/marvin.xml";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 30;
  Run run(Simulation::load(scene));
  Measured warm_up;
  for (int i = 0; i < 5; ++i) run.frame(warm_up);
  constexpr int kBlocks = 5;
  std::map<int, Measured> by_viewers;
  for (int block = 0; block < kBlocks; ++block) {
    for (const int viewers : {0, 1, 4}) {
      std::vector<std::unique_ptr<Viewer>> all;
      Measured ignored;
      while_running(run, ignored, [&] {
        for (int i = 0; i < viewers; ++i) all.push_back(std::make_unique<Viewer>(run.port()));
      });
      std::vector<std::thread> readers;
      for (const std::unique_ptr<Viewer>& viewer : all) {
        readers.emplace_back([&viewer] { read_all(*viewer); });
      }
      for (int i = 0; i < frames; ++i) run.frame(by_viewers[viewers]);
      for (const std::unique_ptr<Viewer>& viewer : all) viewer->shut_down();
      for (std::thread& reader : readers) reader.join();
    }
  }
  std::printf("viewers,frame_ms,publish_ms,thread_ms\n");
  for (const auto& [viewers, measured] : by_viewers) {
    std::printf("%d,%.3f,%.3f,%.3f\n", viewers, median(measured.frame), median(measured.publish),
                median(measured.thread));
  }
  measure_slider(run);
}
