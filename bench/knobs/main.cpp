// Measures what the knobs of light, lens and event cameras buy: the error of each value against a reference, and the
// processor time of a frame, of all threads and of a device that is a CPU.
//
//   knobs [FRAMES [KNOB...]]
//
// Prints one CSV row for each value of each knob, and one with the value "off" for the same camera without the effect.
// Cameras are those of bench/effects in the scene showcase; their errors are the root mean square over the pixels that
// show a surface, of linear radiance; of lamps and skies without the hundredth of them that differs most, since
// highlights of single lights stay points. References of lamps and skies are sums of pictures with one light each, at
// many more places than the knobs have: the integral over the lamp. Other knobs have their most exact value as the
// reference. The error of an event camera is that of the times of its events in microseconds, at the 99th percentile,
// of pixels with as many events as in the reference; `missed` is the share of events in other pixels.
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "bench/timing.h"
#include "elements/lamp.h"
#include "engine/base/even_points.h"
#include "program/output/atomic_file.h"
#include "program/output/exr_file.h"
#include "scenes/showcase/effect_examples.h"

namespace {

using namespace simvis;
namespace fs = std::filesystem;

constexpr int kEventFrames = 4;
constexpr int kWarmUp = 2;               // the first step uploads data, in the second one things have moved
constexpr double kHighlights = 0.01;     // share of the pixels that may show highlights, which stay points in the sum
constexpr std::uint32_t kLights = 1024;  // of the references of lamps and skies

double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Linear RGB of the pixels that show a surface, 0 of others.
using Radiance = std::vector<double>;

class Watched {
 public:
  Watched(const std::string& commands, const std::string& attributes) : simulation_(load(commands, attributes)) {}

  Simulation& simulation() { return simulation_; }

  void step() {
    constexpr int kRoundTrip = 8;  // frames after which things that move are where they were
    drive_examples(simulation_, frame_++ % kRoundTrip);
    simulation_.step();
  }

  Radiance radiance() {
    const Image &color = simulation_.color("WATCH"), &depth = simulation_.depth("WATCH");
    Radiance all;
    for (std::size_t i = 0; i < depth.pixels.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) all.push_back(std::isfinite(depth.pixels[i]) ? color.pixels[4 * i + c] : 0);
    }
    return all;
  }

 private:
  static Simulation load(const std::string& commands, const std::string& attributes) {
    const fs::path file = fs::path(SIMVIS_SOURCE_DIR) / "scenes/showcase/showcase.xml";
    std::ifstream stream(file);
    std::string xml(std::istreambuf_iterator<char>(stream), {});
    xml.insert(xml.rfind("</simvis>"),
               commands +
                   R"(<sensor type="camera" name="WATCH" insert_at="ROOT" pose_offset="-5.2 -0.6 1.9 0 10 4" )"
                   R"(width="320" height="180" hfov="58" outputs="color depth" )" +
                   attributes + "/>");
    Simulation simulation = Simulation::from_string(xml, {}, file.parent_path(), file.string());
    for (const SensorInfo& each : simulation.sensors()) simulation.enable(each.name, each.name == "WATCH");
    return simulation;
  }

  Simulation simulation_;
  int frame_ = 0;
};

// Over the pixels that show a surface, without the `left_out` of all that differ most.
double rms(const Radiance& a, const Radiance& b, double left_out) {
  std::vector<double> squares;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (b[i] != 0) squares.push_back((a[i] - b[i]) * (a[i] - b[i]));
  }
  std::ranges::sort(squares);
  squares.resize(static_cast<std::size_t>((1 - left_out) * static_cast<double>(squares.size())));
  double sum = 0;
  for (const double each : squares) sum += each;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(squares.size(), 1)));
}

void print(const std::string& knob, const std::string& value, double ms, std::optional<double> error,
           std::optional<double> missed = {}) {
  std::printf("%s,%s,%.3f,", knob.c_str(), value.c_str(), ms);
  if (error) std::printf("%.3g", *error);
  std::printf(",");
  if (missed) std::printf("%.3g", *missed);
  std::puts("");
  std::fflush(stdout);
}

/// A knob of the camera or of the scene.
struct Knob {
  std::string name;
  std::vector<std::string> values;               ///< the last one is the most exact
  std::string commands, attributes;              ///< VALUE stands for the value
  std::string plain_commands, plain_attributes;  ///< without the effect
  std::function<Radiance()> reference{};         ///< none: the most exact value is the reference, and has no row
};

std::string with_value(std::string text, const std::string& value) {
  for (std::size_t at = text.find("VALUE"); at != text.npos; at = text.find("VALUE")) text.replace(at, 5, value);
  return text;
}

Watched opened(const Knob& knob, const std::string& value) {
  Watched watched(with_value(knob.commands, value), with_value(knob.attributes, value));
  for (int i = 0; i < kWarmUp; ++i) watched.step();
  return watched;
}

// Each value takes its turn in each round, so that other load on the machine affects all alike.
void measure(const Knob& knob, int frames) {
  std::fprintf(stderr, "knobs: %s\n", knob.name.c_str());
  std::vector<Watched> all;
  std::vector<Radiance> shown;
  Watched plain(knob.plain_commands, knob.plain_attributes);
  for (int i = 0; i < kWarmUp; ++i) plain.step();
  for (const std::string& value : knob.values) {
    all.push_back(opened(knob, value));
    shown.push_back(all.back().radiance());
  }
  const Radiance reference = knob.reference ? knob.reference() : shown.back();
  std::vector<std::vector<double>> times_ms(all.size() + 1);
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < times_ms.size(); ++i) {
      const double before_ms = processor_ms();
      (i < all.size() ? all[i] : plain).step();
      times_ms[i].push_back(processor_ms() - before_ms);
    }
  }
  print(knob.name, "off", bench::median(times_ms.back()), {});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_reference = !knob.reference && i + 1 == all.size();
    print(knob.name, knob.values[i], bench::median(times_ms[i]),
          is_reference ? std::optional<double>() : rms(shown[i], reference, knob.reference ? kHighlights : 0));
  }
}

/// The sum of the pictures of one light each, less the light of the scene itself, which all of them have.
/// `place` sets light i and is called before its picture.
Radiance sum_of_lights(const std::string& commands, std::uint32_t lights,
                       const std::function<void(Simulation&, std::uint32_t)>& place) {
  Watched one(commands, ""), none("", "");
  const auto settle = [](Watched& watched) {
    for (int i = 0; i < kWarmUp; ++i) watched.step();
  };
  settle(none);
  const Radiance scene = none.radiance();
  Radiance sum = scene;
  settle(one);
  for (std::uint32_t i = 0; i < lights; ++i) {
    place(one.simulation(), i);
    one.simulation().step();  // nothing else moves
    const Radiance with = one.radiance();
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += with[k] - scene[k];
  }
  return sum;
}

const std::string kOneLight =
    R"(<element type="light" name="ONE" insert_at="ROOT" shadows="yes" shadow_resolution="512"/>)";

void set_direction(Simulation& simulation, const glm::dvec3& travels) {
  simulation.set("ONE", "azimuth", glm::degrees(std::atan2(-travels.y, -travels.x)));
  simulation.set("ONE", "elevation", glm::degrees(std::asin(std::clamp(-travels.z, -1.0, 1.0))));
}

constexpr double kSunAzimuth_deg = -142, kSunElevation_deg = 38, kSunRadius_deg = 2;

Radiance whole_sun() {
  const double a = glm::radians(kSunAzimuth_deg), e = glm::radians(kSunElevation_deg);
  const glm::dvec3 middle(-std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a), -std::sin(e));
  return sum_of_lights(kOneLight, kLights, [&](Simulation& simulation, std::uint32_t i) {
    set_direction(simulation, direction_of_point({glm::radians(kSunRadius_deg), kLights}, middle, i));
    simulation.set("ONE", "intensity", 1.0 / kLights);
  });
}

/// A clear sky with a bright side, and a dark ground.
glm::dvec3 sky_radiance(const glm::dvec3& way) {
  if (way.z < 0) return glm::dvec3(0.1, 0.08, 0.06);
  const double glow = std::pow(std::max(0.0, glm::dot(way, glm::normalize(glm::dvec3(-1, -0.8, 0.7)))), 40);
  return glm::dvec3(0.2, 0.3, 0.5) + glow * glm::dvec3(4, 3.5, 3);
}

Radiance whole_sky(const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  return sum_of_lights(kOneLight, kLights, [&](Simulation& simulation, std::uint32_t i) {
    const glm::dvec3 way = even_point_of_ball(i, kLights), color = radiance(way);
    set_direction(simulation, -way);
    simulation.set("ONE", "intensity", 4 * std::numbers::pi / kLights);
    simulation.set("ONE", "red", color.r);
    simulation.set("ONE", "green", color.g);
    simulation.set("ONE", "blue", color.b);
  });
}

void write_sky(const fs::path& file) {
  constexpr std::uint32_t kHeight = 256;
  Image image{.width = 2 * kHeight, .height = kHeight, .channels = 4, .pixels = {}};
  std::vector<float>& pixels = image.pixels.overwrite();
  for (std::uint32_t row = 0; row < kHeight; ++row) {
    for (std::uint32_t column = 0; column < 2 * kHeight; ++column) {
      const double a = std::numbers::pi * (1 - (column + 0.5) / kHeight),
                   e = std::numbers::pi * (0.5 - (row + 0.5) / kHeight);
      const glm::dvec3 seen = sky_radiance({std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)});
      for (const double value : {seen.r, seen.g, seen.b, 1.0}) pixels.push_back(static_cast<float>(value));
    }
  }
  write_file(file, encode_exr(&image, nullptr, {}));
}

std::vector<Knob> knobs(const fs::path& sky) {
  const std::string sun = R"(<element type="light" name="LAMP" insert_at="ROOT" azimuth="-142" elevation="38" )"
                          R"(shadows="yes" shadow_resolution="512" )";
  const std::string sky_light = R"(<element type="sky_light" name="DAY" insert_at="ROOT" sky_points="VALUE" )";
  const std::string box = R"(<part name="BOX" shape="box" size="0.3 0.3 0.3" insert_at="ROOT" )"
                          R"(pose_offset="-2 -0.4 0.9 0 0 0"/><element type="pose" name="BOX_DRIVE" insert_at="BOX"/>)";
  return {{"lens_samples",
           {"4", "16", "64", "256"},
           "",
           R"(aperture="0.1" focus_distance="2.5" lens_samples="VALUE")",
           "",
           ""},
          {"motion_samples", {"4", "16", "64", "256"}, box, R"(exposure_time="0.03" motion_samples="VALUE")", box, ""},
          {"rows_per_pose", {"64", "16", "4", "1"}, box, R"(row_time="1e-4" rows_per_pose="VALUE")", box, ""},
          {"lens_oversampling",
           {"1", "2", "4", "8", "16"},
           "",
           R"(distortion="brown_conrady" k1="-0.2" k2="0.05" lens_oversampling="VALUE")",
           "",
           ""},
          {"lamp_points",
           {"2", "4", "8", "16", "32", "64"},
           sun + R"(angular_radius="2" lamp_points="VALUE"/>)",
           "",
           sun + "/>",
           "",
           whole_sun},
          {"sky_points",
           {"16", "32", "64"},
           sky_light + "/>",
           "",
           "",
           "",
           [] { return whole_sky([](const glm::dvec3&) { return glm::dvec3(0.3); }); }},
          {"sky_points of a picture",
           {"16", "32", "64"},
           sky_light + R"(picture=")" + sky.string() + R"("/>)",
           "",
           "",
           "",
           [] { return whole_sky(sky_radiance); }}};
}

/// The times of the events of each pixel and polarity, in the order of time.
using EventTimes = std::map<std::pair<double, double>, std::vector<double>>;

// The thresholds differ: with equal ones the last event after the blade has left a pixel comes where the light is
// exactly as it was before and hardly changes, so that rounding decides on its time.
Simulation event_scene(const std::string& attributes) {
  return Simulation::from_string(
      R"(<simvis><part shape="box" size="6 5 3" name="ROOM" insert_at="ROOT"/>
      <part name="FAN" insert_at="ROOT" pose_offset="2 0 0 0 0 0"/>
      <element type="joint" name="AXLE" insert_at="FAN" axis="1 0 0" lower="-1000" upper="1000"/>
      <part shape="box" size="0.02 1.2 0.2" name="BLADE" insert_at="FAN"/>
      <element type="material" name="PAINT" insert_at="ROOT" part="BLADE" red="0.2" green="0.2" blue="0.2"/>
      <sensor type="event_camera" name="E" insert_at="ROOT" width="48" height="36" threshold_off="0.23" )" +
      attributes + "/></simvis>");
}

double fan_step(Simulation& simulation, int frame, EventTimes* events) {
  simulation.set("AXLE", "value", 60.0 * frame);  // 900 degrees a second
  const double before_ms = processor_ms();
  simulation.step();
  const double took_ms = processor_ms() - before_ms;
  const Reading& reading = simulation.reading("E");
  for (std::size_t row = 0; events != nullptr && row < reading.rows(); ++row) {
    (*events)[{*reading.find("x", row), *reading.find("y", row)}].push_back(*reading.find("time_s", row));
  }
  return took_ms;
}

struct EventRun {
  EventTimes events;
  double frame_ms = 0;
};

EventRun run_events(const std::string& attributes, int frames) {
  Simulation simulation = event_scene(attributes);
  EventRun run;
  fan_step(simulation, 0, nullptr);
  std::vector<double> times_ms;
  for (int frame = 1; frame <= frames; ++frame) times_ms.push_back(fan_step(simulation, frame, &run.events));
  run.frame_ms = bench::median(times_ms);
  return run;
}

void measure_events(const std::string& knob, const std::vector<std::string>& values, const EventTimes& reference) {
  std::fprintf(stderr, "knobs: %s\n", knob.c_str());
  for (const std::string& value : values) {
    const EventRun run = run_events(knob + "=\"" + value + "\"", kEventFrames);
    std::vector<double> off_us{0};
    double missed = 0, all = 0;
    for (const auto& [pixel, times] : reference) {
      all += static_cast<double>(times.size());
      const auto found = run.events.find(pixel);
      if (found == run.events.end() || found->second.size() != times.size()) {
        missed += static_cast<double>(times.size());
        continue;
      }
      for (std::size_t i = 0; i < times.size(); ++i) off_us.push_back(1e6 * std::abs(times[i] - found->second[i]));
    }
    print("event " + knob, value, run.frame_ms, bench::quantile(off_us, 0.99), missed / all);
  }
}

void measure_all_events() {
  const EventTimes reference = run_events(R"(step="0.02" time_error="1e-8")", kEventFrames).events;
  measure_events("step", {"1", "0.5", "0.25", "0.1"}, reference);
  measure_events("time_error", {"1e-4", "1e-5", "5e-7", "1e-8"}, reference);
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 7;
  const std::vector<std::string> chosen(argv + std::min(argc, 2), argv + argc);
  const auto is_chosen = [&](const std::string& knob) {
    return chosen.empty() || std::ranges::count(chosen, knob) > 0;
  };
  if (frames < 1) {
    std::fputs("usage: knobs [FRAMES [KNOB...]]\n", stderr);
    return 2;
  }
  const fs::path sky = fs::temp_directory_path() / ("simvis_knobs_" + std::to_string(::getpid()) + ".exr");
  int status = 0;
  try {
    write_sky(sky);
    std::puts("knob,value,processor_ms,error,missed");
    for (const Knob& knob : knobs(sky)) {
      if (is_chosen(knob.name)) measure(knob, frames);
    }
    if (is_chosen("events")) measure_all_events();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "knobs: %s\n", error.what());
    status = 1;
  }
  fs::remove(sky);
  return status;
}
